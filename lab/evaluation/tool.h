#pragma once
#include <string>
#include <vector>

#include "lab/evaluation/evaluate.h"

/// Where the tool was, and where the reference would have it: forward kinematics of q and of q_ref.
namespace lab {

struct ToolPath {
  std::string frame;                               ///< empty: the robot has none
  std::vector<Eigen::Vector3d> actual, reference;  ///< m, in the world, by step
  std::vector<double> error, turn;                 ///< m, rad: distance and angle between the two
};

/// The frame that is meant: run.tool, or else the last link of the model. -1 if there is none.
int tool_frame(const Run&);

ToolPath tool_path(const Run&);

}  // namespace lab
