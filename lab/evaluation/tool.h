// Poses of the tool, actual and reference: forward kinematics of q and of q_ref.
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lab/evaluation/evaluate.h"

namespace lab {

/// The tool at one step, world frame.
struct ToolStep {
  double time = 0;                    ///< s
  Eigen::Vector3d actual, reference;  ///< m: places
  double error = 0;                   ///< m: distance between them
  double angle = 0;                   ///< rad: between the orientations
};

/// Name of the frame that is judged: run.tool, or else the last link; empty if the robot has none.
std::string tool_frame(const Run&);

/// Step by step; none if the robot has no such frame.
void for_each_tool_step(const Run&, const std::function<void(const ToolStep&)>& visit);

/// Puts the metrics of the tool into `out`.
void add_tool_metrics(nlohmann::json& out, const Run&);

}  // namespace lab
