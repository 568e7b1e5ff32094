// Wrenches from outside on the robot: a push on a link, a payload's weight, a contact.
#pragma once

#include <vector>

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// A wrench (N m; N) on the body that a frame is fixed to, written in `reference`:
//   LOCAL                axes and origin of the frame
//   LOCAL_WORLD_ALIGNED  axes of the world, about the frame's origin: a push at that point
//   WORLD                axes of the world, about the world's origin
struct FrameWrench {
  FrameWrench(FrameIndex f, const Force& w, ReferenceFrame r) : frame(f), wrench(w), reference(r) {}

  FrameIndex frame;
  Force wrench;
  ReferenceFrame reference;
};

using FrameWrenches = std::vector<FrameWrench>;

namespace inner {
// tau += sign * sum of J' f. Checks the wrenches.
void addWrenchEfforts(const char* function, const Model& model, Data& data, const ConstVectorRef& q,
                      const FrameWrenches& wrenches, double sign, Eigen::VectorXd& tau);
// dtau_dq += sign * the derivative of that sum in q.
void addWrenchDerivatives(const char* function, const Model& model, Data& data, const ConstVectorRef& q,
                          const FrameWrenches& wrenches, double sign, PaddedMatrix& dtau_dq);
}  // namespace inner

}  // namespace rbd
