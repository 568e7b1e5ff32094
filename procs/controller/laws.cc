// The table of controllers, and their laws. e = q_ref - q (by `difference`), e' = v_ref - v; M, nle and g are those of
// the controller's own model. Sources: Khatib, A unified approach for motion and force control, 1987 (the projection of
// the posture); Hogan, Impedance control, 1985.
#include <rbd/algorithm/center_of_mass.h>
#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/jacobian.h>
#include <rbd/algorithm/minverse.h>
#include <rbd/algorithm/rnea.h>

#include <Eigen/Eigenvalues>
#include <exception>

#include "lab/experiment/joints.h"
#include "procs/controller/controller.h"

namespace lab::controller {
namespace {

// tau = 0
void none(const Config&, State&, const Input&, Eigen::VectorXd& tau) { tau.setZero(); }

// tau = Kp e + Kd e'
void pd(const Config&, State& s, const Input&, Eigen::VectorXd& tau) {
  tau = s.gains.kp.cwiseProduct(s.e) + s.gains.kd.cwiseProduct(s.e_dot);
}

// tau = Kp e + Kd e' + g(q)
void pd_gravity(const Config& c, State& s, const Input& in, Eigen::VectorXd& tau) {
  tau = s.gains.kp.cwiseProduct(s.e) + s.gains.kd.cwiseProduct(s.e_dot) +
        rbd::computeGeneralizedGravity(c.model, s.data, in.state.q);
}

// tau = M(q) (a_ref + Kp e + Kd e') + nle(q, v), so that e'' + Kd e' + Kp e = 0
void computed_torque(const Config& c, State& s, const Input& in, Eigen::VectorXd& tau) {
  s.a = in.reference.a + s.gains.kp.cwiseProduct(s.e) + s.gains.kd.cwiseProduct(s.e_dot);
  rbd::rnea(c.model, s.data, in.state.q, in.state.v, s.a, tau);
}

using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 6, 6>;  // no allocation
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 6, 1>;

/// The shortest x with A x = b, for a symmetric positive semidefinite A. Directions in which A is below `min_ratio` times
/// its largest eigenvalue are left out: there the joints cannot move the task.
SmallVector solve(const Small& A, const SmallVector& b, double min_ratio) {
  const Eigen::SelfAdjointEigenSolver<Small> eigen(A);
  const double floor = min_ratio * eigen.eigenvalues()[A.rows() - 1];  // sorted, smallest first
  SmallVector x = SmallVector::Zero(A.rows());
  for (Eigen::Index i = 0; i < A.rows(); ++i)
    if (eigen.eigenvalues()[i] > floor)
      x += eigen.eigenvectors().col(i).dot(b) / eigen.eigenvalues()[i] * eigen.eigenvectors().col(i);
  return x;
}

/// The Jacobian rows (angular, linear) that the impedance controls: a part without stiffness and damping stays free.
struct Rows {
  int first = 0, count = 0;
};

Rows held_rows(const Gains& gains) {
  const auto held = [&](int part) { return gains.stiffness[part] > 0 || gains.damping[part] > 0; };
  if (held(0)) return {0, held(1) ? 6 : 3};
  return {3, held(1) ? 3 : 0};
}

/// tau0 -= J^T Lambda J M^-1 tau0, Lambda = (J M^-1 J^T)^-1: the rest of tau0 does not accelerate the tool.
void project(const Eigen::Ref<const Eigen::MatrixXd>& J, State& s, Eigen::VectorXd& tau0) {
  constexpr double kOutOfReach = 1e-8;  // ratio of squares: mobility below 1e-4 of the best direction's
  auto MinvJt = s.minv_jt.leftCols(J.rows());
  MinvJt.noalias() = s.minv * J.transpose();
  Small mobility(J.rows(), J.rows());
  mobility.noalias() = J * MinvJt;
  SmallVector acceleration(J.rows());
  acceleration.noalias() = MinvJt.transpose() * tau0;
  tau0.noalias() -= J.transpose() * solve(mobility, acceleration, kOutOfReach);
}

// tau = J^T (K dx + D dx') + nle(q, v) + N^T (Kp e + Kd e'), N^T = 1 - J^T Lambda J M^-1. dx is the displacement from the
// tool's pose to that at q_ref, in world axes: the rotation vector of R_ref R^T, and p_ref - p.
void cartesian_impedance(const Config& c, State& s, const Input& in, Eigen::VectorXd& tau) {
  rbd::forwardKinematics(c.model, s.data, in.reference.q, in.reference.v);
  const rbd::SE3 wanted = s.data.oMf[c.frame];
  const rbd::Motion wanted_speed = rbd::getFrameVelocity(c.model, s.data, c.frame, rbd::LOCAL_WORLD_ALIGNED);
  rbd::forwardKinematics(c.model, s.data, in.state.q, in.state.v);
  const rbd::SE3 pose = s.data.oMf[c.frame];
  const rbd::Motion velocity_error =
      wanted_speed - rbd::getFrameVelocity(c.model, s.data, c.frame, rbd::LOCAL_WORLD_ALIGNED);
  const Eigen::Vector3d turn = rbd::log3(Eigen::Matrix3d(wanted.rotation() * pose.rotation().transpose()));
  const auto& [stiffness, damping] = std::pair(s.gains.stiffness, s.gains.damping);
  rbd::Vector6d wrench;
  wrench.head<3>() = stiffness[0] * turn + damping[0] * velocity_error.angular();
  wrench.tail<3>() =
      stiffness[1] * (wanted.translation() - pose.translation()) + damping[1] * velocity_error.linear();

  rbd::computeFrameJacobian(c.model, s.data, in.state.q, c.frame, rbd::LOCAL_WORLD_ALIGNED, s.jacobian);
  rbd::nonLinearEffects(c.model, s.data, in.state.q, in.state.v, tau);
  tau.noalias() += s.jacobian.transpose() * wrench;

  s.posture = s.gains.kp.cwiseProduct(s.e) + s.gains.kd.cwiseProduct(s.e_dot);
  const Rows rows = held_rows(s.gains);
  if (rows.count > 0) {
    rbd::computeMinverse(c.model, s.data, in.state.q, s.minv);
    project(s.jacobian.middleRows(rows.first, rows.count), s, s.posture);
  }
  tau += s.posture;
}

// u = v_ref + Kp e, the posture; v_d = u + Jcom^+ (com'_ref + com_gain (com_ref - com) - Jcom u): of all joint velocities
// that move the centre of mass as wanted, the one nearest to u. tau = M(q) (a_ref + Kd (v_d - v)) + nle(q, v).
void com_velocity(const Config& c, State& s, const Input& in, Eigen::VectorXd& tau) {
  // handbook 8.3 leaves out singular values below 1e-6 of the largest; in a loop that would ask for speeds of 1e6, so
  // here a direction in which the joints move the centre of mass 100 times less than in the best one is left out
  constexpr double kOutOfReach = 1e-4;  // ratio of squares
  rbd::centerOfMass(c.model, s.data, in.reference.q, in.reference.v);
  const Eigen::Vector3d com_ref = s.data.com[0], com_speed_ref = s.data.vcom[0];
  rbd::jacobianCenterOfMass(c.model, s.data, in.state.q, s.com_jacobian);
  s.posture = in.reference.v + s.gains.kp.cwiseProduct(s.e);
  const Eigen::Vector3d missing =
      com_speed_ref + s.gains.com_gain * (com_ref - s.data.com[0]) - s.com_jacobian * s.posture;
  const Small square = s.com_jacobian * s.com_jacobian.transpose();  // J^+ = J^T (J J^T)^+
  s.posture.noalias() += s.com_jacobian.transpose() * solve(square, missing, kOutOfReach);
  s.a = in.reference.a + s.gains.kd.cwiseProduct(s.posture - in.state.v);
  rbd::rnea(c.model, s.data, in.state.q, in.state.v, s.a, tau);
}

void require_fixed_base(const Experiment& e, const Config& c) {
  if (floats(c.model))
    fail(e, "controller.kind",
         "'" + std::string(c.kind->name) + "' needs a fixed base; '" + c.model.name + "' floats");
}

void prepare_impedance(const Experiment& e, Config& c) {
  require_fixed_base(e, c);
  std::vector<std::string> names;
  for (const rbd::Frame& frame : c.model.frames) names.push_back(frame.name);
  const std::string& tool = e.controller.frame;
  if (tool.empty())
    fail(e, "controller.frame",
         "is missing; name the frame that cartesian_impedance holds, one of " + list_of(names));
  if (!c.model.existFrame(tool)) {
    const std::string near = did_you_mean(tool, names);
    fail(e, "controller.frame",
         "'" + c.model.name + "' has no frame '" + tool + "'" +
             (near.empty() ? "; it has " + list_of(names) : near));
  }
  c.frame = c.model.frameId(tool);
  try {  // M of the controller's model must be invertible: it is not if a joint moves no inertia
    rbd::Data data(c.model);
    rbd::computeMinverse(c.model, data, rbd::neutral(c.model));
  } catch (const std::exception& error) {
    fail(e, "controller.model", std::string("leaves nothing to move: ") + error.what());
  }
}

void prepare_com(const Experiment& e, Config& c) {
  require_fixed_base(e, c);
  if (!(rbd::computeTotalMass(c.model) > 0))
    fail(e, "controller.model", "leaves no mass, and so no centre of mass");
}

constexpr Kind kKinds[] = {
    {"none", "tau = 0", none, nullptr, ""},
    {"pd", "tau = kp e + kd e'", pd, nullptr, "kp kd"},
    {"pd_gravity", "tau = kp e + kd e' + g(q)", pd_gravity, nullptr, "kp kd"},
    {"computed_torque", "tau = M(q) (a_ref + kp e + kd e') + nle(q, v)", computed_torque, nullptr, "kp kd"},
    {"cartesian_impedance",
     "tau = J^T (stiffness dx + damping dx') + nle(q, v) + (1 - J^T (J M^-1 J^T)^-1 J M^-1) (kp e + kd e')",
     cartesian_impedance, prepare_impedance, "kp kd frame stiffness damping"},
    {"com_velocity",
     "tau = M(q) (a_ref + kd (v_d - v)) + nle(q, v), v_d = u + Jcom^+ (com'_ref + com_gain (com_ref - com) - "
     "Jcom u), "
     "u = v_ref + kp e",
     com_velocity, prepare_com, "kp kd com_gain"},
};

}  // namespace

std::span<const Kind> kinds() { return kKinds; }

}  // namespace lab::controller
