// How well each joint follows its reference, and how near it comes to its limits.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/evaluation/evaluate.h"

namespace lab {

/// A joint with one degree of freedom, and where its numbers are in q and v.
struct TrackedJoint {
  std::string name;
  int iq = 0, iv = 0;
};

/// The joints that have errors, in model order. A floating base and joints that mimic others have none.
std::vector<TrackedJoint> joints_of(const rbd::Model&);

/// Puts the metrics of errors, efforts, speeds and margins into `out`, and per joint into out["joints"].
void add_tracking_metrics(nlohmann::json& out, const Run&);

}  // namespace lab
