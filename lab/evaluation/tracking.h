#pragma once
#include <string>
#include <vector>

#include "lab/evaluation/evaluate.h"
#include "lab/evaluation/figures.h"

/// How well each joint followed its reference, and how near it came to its limits.
namespace lab {

struct JointFigures {
  std::string name;
  int iq = 0, iv = 0;  ///< where it is in q and v
  Figures error, effort, speed;
  double effort_share = 0, speed_share = 0;  ///< of the limit; 0 where there is none
  double margin = 0;                         ///< from the nearer position limit; infinite where there is none
  int64_t settled_since = -1;  ///< step from which the error stayed in the band; -1 = it did not
};

struct Tracking {
  std::vector<JointFigures> joints;  ///< those with one degree of freedom, in model order
  double handbook = 0;               ///< mean over steps of norm(e) / nq
};

/// The joints that have errors: one degree of freedom; a floating base and joints that follow others have none.
std::vector<JointFigures> joints_of(const rbd::Model&);

Tracking track(const Run&);

}  // namespace lab
