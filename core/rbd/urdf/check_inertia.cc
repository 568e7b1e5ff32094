#include "rbd/urdf/check_inertia.h"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <vector>

#include "rbd/urdf/xml.h"

namespace rbd::urdf {
namespace {

// Principal moments, ascending.
Eigen::Vector3d moments_of(const Eigen::Matrix3d& inertia) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(inertia, Eigen::EigenvaluesOnly).eigenvalues();
}

// Files have about six digits: a smaller negative moment counts as zero.
double slack_of(const Eigen::Vector3d& moments) { return 1e-6 * moments.cwiseAbs().maxCoeff(); }

// A radius of gyration of at most a micrometre is a point mass.
bool is_point(const Eigen::Vector3d& moments, double mass) {
  return moments.cwiseAbs().maxCoeff() <= 1e-12 * mass;
}

// One link's own inertia; `body`: all that moves with it; `fixed`: the link is fixed to the world.
void check_link(const Link& link, const Inertia& body, bool fixed, Report& report) {
  if (!link.inertial) return;
  const double mass = link.inertial->mass;
  const Eigen::Matrix3d& tensor = link.inertial->tensor;
  const Eigen::Vector3d moments = moments_of(tensor);
  const std::string seen = "(principal moments " + show(std::span(moments.data(), 3)).substr(1);
  const std::string owner = owner_of(link);
  const int line = link.inertial->tensor_line;
  if (tensor.isZero(0) && mass == 0) return;
  if (is_point(moments, mass)) {
    report.warn(line, owner, "inertia is zero: a point mass of " + show(mass) + " kg");
  } else if (moments[0] < -slack_of(moments)) {
    const Eigen::Vector3d whole = moments_of(body.inertia());
    const bool harmless = fixed || whole[0] >= -slack_of(whole);
    report.add(harmless ? Severity::Warning : Severity::Error, line, owner,
               "inertia is not positive definite " + seen + ": look at its signs and products");
  } else if (mass == 0) {
    report.warn(line, owner, "inertia without mass " + seen);
  } else if (moments[0] <= slack_of(moments)) {
    report.warn(line, owner, "inertia is singular " + seen);
  } else if (moments[2] > moments[0] + moments[1] + slack_of(moments)) {
    report.warn(line, owner,
                "no body has this inertia: one moment exceeds the sum of the others " + seen +
                    ", the largest may be " + show(moments[0] + moments[1]));
  } else if (const double reach = std::sqrt(moments[2] / mass); reach > 100) {
    report.warn(line, owner,
                "a mass of " + show(mass) + " kg with this inertia lies " + show(reach) +
                    " m from its centre: URDF has kg m^2, is this kg mm^2? " + seen);
  }
}

}  // namespace

void check_inertia(const Model& model, const Description& robot, Report& report) {
  for (const auto& [name, link] : robot.links) {
    const JointIndex carrier = model.frames[model.getFrameId(name, BODY)].parentJoint;
    check_link(link, model.inertias[carrier], carrier == 0, report);
  }

  std::vector<bool> inner(model.njoints, false);  // joints with another joint below
  for (JointIndex i = 1; i < model.njoints; ++i) inner[model.parents[i]] = true;
  for (JointIndex i = 1; i < model.njoints; ++i) {
    const Inertia& body = model.inertias[i];
    const JointModel& joint = model.joints[i];
    const auto found = robot.joints.find(model.names[i]);  // not found: the root joint
    const int line = found == robot.joints.end() ? 0 : found->second.line;
    const std::string owner = "joint '" + model.names[i] + "'";

    // the body's inertia along or about its joint's own axis
    const bool slides = joint.kind() == JointKind::Prismatic;
    const Eigen::Vector3d none = Eigen::Vector3d::Zero();
    const Motion unit = slides ? Motion(none, joint.axis()) : Motion(joint.axis(), none);
    const bool still = joint.kind_nv() == 1 && body.vtiv(unit) <= 1e-12 * body.mass();
    const char* singular = ": the mass matrix is singular unless the joint has armature";
    const std::string missing = " (<inertial> missing, or mass 0)";

    if (body.mass() == 0 && body.inertia().isZero(0)) {
      report.warn(line, owner,
                  inner[i] ? "the body between it and the next joint has no mass" + missing
                           : "the body it moves has no mass" + missing + singular);
    } else if (!inner[i] && still) {
      report.warn(line, owner, std::string("the body it moves has no inertia about its axis") + singular);
    }
  }
}

}  // namespace rbd::urdf
