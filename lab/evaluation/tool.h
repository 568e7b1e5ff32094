// Poses of the tool, actual and reference: forward kinematics of q and of q_ref.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/evaluation/evaluate.h"

namespace lab {

struct ToolPath {
  std::string frame;                               ///< empty: the robot has none
  std::vector<Eigen::Vector3d> actual, reference;  ///< m, in the world, by step
  std::vector<double> error, angle;                ///< m, rad: distance and angle between the two
};

ToolPath tool_path(const Run&);

/// Puts the metrics of the tool into `out`.
void add_tool_metrics(nlohmann::json& out, const Run&);

}  // namespace lab
