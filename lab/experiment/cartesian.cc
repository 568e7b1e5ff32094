#include "lab/experiment/cartesian.h"

#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/inverse_kinematics.h>

#include <cmath>

#include "core/util/number.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/joints.h"

namespace lab {
namespace {

std::string target_fault(const rbd::Model& model, const Action& action) {
  if (const std::string fault = frame_fault(model, action.target); !fault.empty()) return fault;
  const std::vector<double>& x = action.values;
  if (x.size() != 3 && x.size() != 7)
    return "goal of frame '" + action.target + "' has " + std::to_string(x.size()) +
           " values, expected 3 (position) or 7 (and a quaternion)";
  for (size_t i = 0; i < 3; ++i)
    if (!(std::abs(x[i]) <= 1e6))
      return "goal of frame '" + action.target + "' is " + number(x[i]) + " m away";
  if (x.size() == 7) {
    const double length = Eigen::Vector4d(x[3], x[4], x[5], x[6]).norm();
    if (!(std::abs(length - 1) <= 1e-6))
      return "goal of frame '" + action.target + "' has a quaternion of length " + number(length);
  }
  return "";
}

}  // namespace

IkResult find_configuration(const rbd::Model& model, const Action& action, const Eigen::VectorXd* from) {
  IkResult found;
  found.fault = target_fault(model, action);
  if (!found.fault.empty()) return found;
  const std::vector<double>& x = action.values;
  const Eigen::Vector3d position(x[0], x[1], x[2]);
  rbd::FrameTarget target{model.frameId(action.target), rbd::SE3(Eigen::Matrix3d::Identity(), position),
                          false};
  if (x.size() == 7)
    target = {target.frame, rbd::SE3(Eigen::Quaterniond(x[6], x[3], x[4], x[5]), position), true};

  rbd::IkScratch scratch(model);
  rbd::IkOptions options;
  if (from) {
    options.restarts = 0;
    options.rest = found.q = *from;
    if (rbd::inverseKinematics(model, scratch, target, options, found.q)) return found;
  }
  options.restarts = rbd::IkOptions().restarts;
  found.q = rbd::neutral(model);
  const rbd::IkResult result = rbd::inverseKinematics(model, scratch, target, options, found.q);
  if (!result) found.fault = "'" + action.target + "' cannot be there: " + rbd::describe(model, result);
  return found;
}

}  // namespace lab
