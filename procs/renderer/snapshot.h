// The data of a step, and of a push, that pictures show.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>

namespace lab::renderer {

struct Snapshot {
  int64_t step = 0;
  double time = 0;            ///< s
  Eigen::VectorXd q, v;       ///< v may be empty
  Eigen::VectorXd reference;  ///< q of the reference for this step; empty if there is none
};

/// A force on a frame's origin, for some time.
struct Push {
  double begin = 0, end = 0;  ///< s
  std::string frame;
  Eigen::Vector3d force;  ///< N, world axes
};

}  // namespace lab::renderer
