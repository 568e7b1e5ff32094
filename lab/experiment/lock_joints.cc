#include <rbd/algorithm/configuration.h>
#include <rbd/edit/reduced_model.h>

#include "lab/experiment/robot.h"

namespace lab {

void lock_joints(rbd::Model& model, rbd::GeometryModel& geometry,
                 const std::map<std::string, double>& where) {
  Eigen::VectorXd q = rbd::neutral(model);
  std::vector<rbd::JointIndex> joints;
  for (const auto& [name, place] : where) {
    joints.push_back(model.jointId(name));
    q[model.joints[joints.back()].idx_q()] = place;
  }
  model = rbd::buildReducedModel(model, geometry, joints, q, geometry);
}

}  // namespace lab
