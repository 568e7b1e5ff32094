// Reaches: each time the reference comes to rest at a new place, and how the robot gets there.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/evaluation/evaluate.h"

namespace lab {

struct Reach {
  size_t begin = 0;    ///< index of the last logged step before the reference moves
  size_t arrival = 0;  ///< of the first at which it rests at the target
  size_t end = 0;      ///< of the last before it moves again, or of the run

  struct Joint {
    double displacement = 0;  ///< rad, m: from the place before to the target
    double settling = 0;  ///< s from arrival until the joint stays in the band up to the end; NaN if never
    double overshoot =
        0;  ///< rad, m: farthest beyond the target from arrival on; NaN if |displacement| <= band
    double overshoot_share = 0;  ///< of the displacement
    double steady_error = 0;     ///< rad, m: |mean error| over the last tenth of the rest
  };
  std::vector<Joint> joints;  ///< as joints_of(model)
};

/// In the order of time. A reference that never rests, or never leaves its first place, has none. Resting: v_ref is
/// 0 and q_ref is what it was a step before; at the last step v_ref = 0 alone counts.
std::vector<Reach> reaches(const Run&);

/// Puts the metrics of reaches into `out`, per joint into out["joints"], and one by one into out["reaches"].
void add_reach_metrics(nlohmann::json& out, const Run&);

}  // namespace lab
