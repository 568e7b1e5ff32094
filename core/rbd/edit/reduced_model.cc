#include "rbd/edit/reduced_model.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "rbd/algorithm/argument_checks.h"
#include "rbd/edit/model_copy.h"

namespace rbd {
namespace {

constexpr const char* kBuildReducedModel = "buildReducedModel";

// Whether a joint is locked, by itself or by one that it follows.
bool isLocked(const Model& model, const std::vector<bool>& listed, JointIndex joint) {
  while (joint >= 0 && !listed[joint]) joint = model.mimic(joint).leader;
  return joint >= 0;
}

// The joint's own numbers at q, also of a follower.
Eigen::VectorXd numbersOf(const Model& model, JointIndex j, const ConstVectorRef& q) {
  const Mimic& mimic = model.mimic(j);
  if (mimic.leader < 0) return q.segment(model.joints[j].idx_q(), model.joints[j].nq());
  return Eigen::VectorXd::Constant(1, mimic.multiplier * numbersOf(model, mimic.leader, q)[0] + mimic.offset);
}

// Where these numbers put the joint's moving part, seen from neutral: the pose of a robot of this joint
// alone.
SE3 displacement(const JointModel& joint, const Eigen::VectorXd& numbers) {
  Model alone;
  alone.addJoint(0, joint, SE3::Identity(), "joint");
  Data data(alone);
  forwardKinematics(alone, data, numbers);
  return data.oMi[1];
}

std::pair<Model, inner::CopyMap> reduce(const Model& model, const std::vector<JointIndex>& joints_to_lock,
                                        const ConstVectorRef& q) {
  inner::checkQ(kBuildReducedModel, "q", model, q);
  inner::checkQuaternions(kBuildReducedModel, model, q);
  std::vector<bool> listed(static_cast<std::size_t>(model.njoints), false);
  for (const JointIndex j : joints_to_lock) {
    inner::checkJoint(kBuildReducedModel, model, j);
    if (j == 0)
      throw std::invalid_argument(std::string(kBuildReducedModel) +
                                  ": joint 0 is the universe, it cannot be locked");
    listed[j] = true;
  }

  inner::CopyPlan plan;
  plan.weld.resize(static_cast<std::size_t>(model.njoints));
  for (JointIndex j = 1; j < model.njoints; ++j) {
    if (isLocked(model, listed, j)) plan.weld[j] = displacement(model.joints[j], numbersOf(model, j, q));
  }
  Model reduced;
  reduced.name = model.name;
  reduced.gravity = model.gravity;
  reduced.terms = model.terms;
  inner::CopyMap map = inner::copyModel(kBuildReducedModel, model, plan, reduced);
  return {std::move(reduced), std::move(map)};
}

}  // namespace

Model buildReducedModel(const Model& model, const std::vector<JointIndex>& joints_to_lock,
                        const ConstVectorRef& q) {
  return reduce(model, joints_to_lock, q).first;
}

Model buildReducedModel(const Model& model, const GeometryModel& geometry,
                        const std::vector<JointIndex>& joints_to_lock, const ConstVectorRef& q,
                        GeometryModel& reduced_geometry) {
  std::pair<Model, inner::CopyMap> out = reduce(model, joints_to_lock, q);
  GeometryModel shapes;
  inner::copyShapes(geometry, out.second, "", shapes);
  reduced_geometry = std::move(shapes);
  return std::move(out.first);
}

}  // namespace rbd
