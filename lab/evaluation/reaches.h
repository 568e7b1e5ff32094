#pragma once
#include <string>
#include <vector>

#include "lab/evaluation/evaluate.h"

/// Reaches: each time the reference came to rest at a new place, and how the robot got there.
namespace lab {

struct Reach {
  size_t begin = 0;    ///< index of the last logged step before the reference moves
  size_t arrival = 0;  ///< of the first at which it rests at the target
  size_t end = 0;      ///< of the last before it moves again, or of the run

  struct Joint {
    double way = 0;       ///< rad, m: from the place before to the target
    double settling = 0;  ///< s from arrival until the joint stays in the band up to the end; NaN if never
    double overshoot =
        0;  ///< rad, m: farthest beyond the target from arrival on; NaN if the way is no longer than the band
    double overshoot_share = 0;  ///< of the way
    double steady_error = 0;     ///< rad, m: |mean error| over the last tenth of the rest
  };
  std::vector<Joint> joints;  ///< as joints_of(model)
};

/// In the order of time. A reference that never rests, or never leaves its first place, has none. Resting: v_ref is
/// 0 and q_ref is what it was a step before; at the last step v_ref = 0 alone counts.
std::vector<Reach> reaches(const Run&);

/// Figures over several reaches. NaN: some reach has no value, or there are none.
struct ReachFigures {
  double settling_max, settling_mean, overshoot_max, overshoot_share_max, steady_error_max;
};
/// Of one joint, or, with -1, of the worst joint of each reach.
ReachFigures over_reaches(const std::vector<Reach>&, int joint);

}  // namespace lab
