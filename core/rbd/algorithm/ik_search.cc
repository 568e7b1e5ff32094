#include "rbd/algorithm/ik_search.h"

#include <algorithm>
#include <cmath>

#include "rbd/algorithm/configuration.h"
#include "rbd/algorithm/jacobian.h"
#include "rbd/kernel/joint_kinds.h"

namespace rbd::inner {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A := its Cholesky factor (lower), then r := A^-1 r. Eigen's would allocate for larger ones.
void solve(Eigen::MatrixXd& A, Eigen::VectorXd& r, Eigen::Index n) {
  for (Eigen::Index j = 0; j < n; ++j) {
    for (Eigen::Index k = 0; k < j; ++k) {
      for (Eigen::Index i = j; i < n; ++i) A(i, j) -= A(i, k) * A(j, k);
    }
    const double d = std::sqrt(A(j, j));
    for (Eigen::Index i = j; i < n; ++i) A(i, j) /= d;
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    r[j] /= A(j, j);
    for (Eigen::Index i = j + 1; i < n; ++i) r[i] -= A(i, j) * r[j];
  }
  for (Eigen::Index j = n - 1; j >= 0; --j) {
    for (Eigen::Index i = j + 1; i < n; ++i) r[j] -= A(i, j) * r[i];
    r[j] /= A(j, j);
  }
}

// The farthest that a joint's moving part comes from its place at neutral, m.
double travel(const Model& model, JointIndex j) {
  const KernelTree& tree = model.tree();
  const auto largest = [&](int k) {
    const int at = tree.mimic.q_source[k];
    return std::abs(tree.mimic.q_ratio[k]) *
               std::max(std::abs(model.lowerPositionLimit[at]), std::abs(model.upperPositionLimit[at])) +
           std::abs(tree.mimic.q_offset[k]);
  };
  double sum = 0;
  for (int k = 0; k < traits(model.joints[j].kind()).kernel_joints; ++k) {
    sum += largestDisplacement(tree.joints[tree.bodyOf[j] - k], largest);
  }
  return sum;
}

}  // namespace

bool outOfReach(const Model& model, const FrameTarget& target, double tolerance) {
  const Frame& frame = model.frames[target.frame];
  double reach = 0;
  Eigen::Vector3d last = frame.placement.translation();
  for (JointIndex j = frame.parentJoint; j > 0; j = model.parents[j]) {
    reach += last.norm() + travel(model, j);
    last = model.jointPlacements[j].translation();
  }
  return (target.pose.translation() - last).norm() > reach * (1 + 1e-12) + tolerance;
}

// s.e and its size at q; leaves what linearise() needs in s.data.
IkErrors IkSearch::evaluate(const Eigen::VectorXd& q) {
  computeJointJacobians(model_, s_.data, q);
  IkErrors out{0, 0, 0};
  Eigen::Index row = 0;
  for (const FrameTarget& target : targets_) {
    const SE3& pose = updateFramePlacement(model_, s_.data, target.frame);
    const Eigen::Vector3d error = target.pose.translation() - pose.translation();
    s_.e.segment<3>(row) = error;
    out.position = std::max(out.position, error.norm());
    row += 3;
    if (!target.rotation) continue;
    const Eigen::Matrix3d turn = target.pose.rotation() * pose.rotation().transpose();
    const Eigen::Vector3d angle = log3(Eigen::Quaterniond(turn).normalized());
    s_.e.segment<3>(row) = options_.length * angle;
    out.rotation = std::max(out.rotation, angle.norm());
    row += 3;
  }
  out.cost = s_.e.head(rows_).squaredNorm() / 2;
  return out;
}

// J, the gradient J' e and the room to the limits, at the configuration of the last evaluate (which is s.at).
// The gradient is exact although J is the geometric Jacobian: a rotation error is its own axis.
void IkSearch::linearise() {
  Eigen::Index row = 0;
  for (const FrameTarget& target : targets_) {
    getFrameJacobian(model_, s_.data, target.frame, LOCAL_WORLD_ALIGNED, s_.frame_J);
    s_.J.middleRows<3>(row) = s_.frame_J.bottomRows<3>();
    row += 3;
    if (!target.rotation) continue;
    s_.J.middleRows<3>(row) = options_.length * s_.frame_J.topRows<3>();
    row += 3;
  }
  size_ = 0;
  for (Eigen::Index k = 0; k < model_.nv; ++k) {
    size_ += s_.J.col(k).head(rows_).squaredNorm();
    s_.gradient[k] = s_.J.col(k).head(rows_).dot(s_.e.head(rows_));
  }
  s_.lower_step.setConstant(-kInfinity);
  s_.upper_step.setConstant(kInfinity);
  for (const JointModel& joint : model_.joints) {
    if (!isVectorSpace(joint.manifold())) continue;  // clamp() alone keeps the limits of the others
    for (int k = 0; k < joint.nv(); ++k) {
      const int iq = joint.idx_q() + k, iv = joint.idx_v() + k;
      s_.lower_step[iv] = model_.lowerPositionLimit[iq] - s_.at[iq];
      s_.upper_step[iv] = model_.upperPositionLimit[iq] - s_.at[iq];
    }
  }
}

// Whether a limit keeps dof k from following its gradient.
bool IkSearch::blocked(Eigen::Index k) const {
  return (s_.gradient[k] > 0 && s_.upper_step[k] <= 0) || (s_.gradient[k] < 0 && s_.lower_step[k] >= 0);
}

// Whether no dof that may still move changes the error to first order.
bool IkSearch::stationary() const {
  double sum = 0;
  for (Eigen::Index k = 0; k < model_.nv; ++k) {
    if (!blocked(k)) sum += s_.gradient[k] * s_.gradient[k];
  }
  return sum <= 1e-16 * size_ * s_.e.head(rows_).squaredNorm();
}

// s.dq := the minimum of |e - J dq|^2 + lambda |dq - dq_preferred|^2 between the limits. A dof whose step passes a
// limit stops there, and the others are solved again. False when there is no finite step.
//
// In the dual form dq = dq_preferred + J' y, (J J' + lambda) y = e - J dq_preferred, whose size is that of the targets.
bool IkSearch::step(double lambda) {
  const Eigen::Index m = rows_;
  std::fill(s_.clamped.begin(), s_.clamped.end(), 0);
  lambda += 1e-13 * size_;  // what a Cholesky factorisation can bear
  for (bool again = true; again;) {
    s_.A.topLeftCorner(m, m).setZero();
    s_.r.head(m) = s_.e.head(m);
    for (Eigen::Index k = 0; k < model_.nv; ++k) {
      const auto column = s_.J.col(k).head(m);
      s_.r.head(m) -= (s_.clamped[k] ? s_.dq[k] : s_.dq_preferred[k]) * column;
      if (s_.clamped[k]) continue;
      for (Eigen::Index j = 0; j < m; ++j) {
        for (Eigen::Index i = j; i < m; ++i) s_.A(i, j) += column[i] * column[j];
      }
    }
    for (Eigen::Index i = 0; i < m; ++i) s_.A(i, i) += lambda;
    solve(s_.A, s_.r, m);
    again = false;
    for (Eigen::Index k = 0; k < model_.nv; ++k) {
      if (s_.clamped[k]) continue;
      s_.dq[k] = s_.dq_preferred[k] + s_.J.col(k).head(m).dot(s_.r.head(m));
      if (!std::isfinite(s_.dq[k])) return false;
      const double bounded = std::min(std::max(s_.dq[k], s_.lower_step[k]), s_.upper_step[k]);
      if (bounded == s_.dq[k]) continue;
      s_.dq[k] = bounded;
      s_.clamped[k] = again = true;
    }
  }
  return true;
}

// How much a step along s.dq would lower the cost, were the error linear.
double IkSearch::predictedReduction() const {
  double cost = 0;
  for (Eigen::Index i = 0; i < rows_; ++i) {
    double left = s_.e[i];
    for (Eigen::Index k = 0; k < model_.nv; ++k) left -= s_.J(i, k) * s_.dq[k];
    cost += left * left / 2;
  }
  return s_.e.head(rows_).squaredNorm() / 2 - cost;
}

IkStop IkSearch::reach(IkErrors& errors) {
  s_.dq_preferred.setZero();
  errors = evaluate(s_.at);
  linearise();
  // far away the error is no measure of how long a step may be
  double factor = std::min(1.0, size_ / errors.cost), growth = 2;
  double before = kInfinity;  // the error some iterations ago
  for (int n = 0; n < options_.iterations; ++n) {
    if (converged(errors)) return IkStop::Converged;
    if (stationary()) return IkStop::Stalled;
    if (n % 10 == 0) {
      const double now = std::sqrt(2 * errors.cost);
      if (before - now < options_.position_tolerance / 10) return IkStop::Stalled;
      before = now;
    }
    // the first step of any length that comes nearer; short ones follow the gradient, so there is one
    for (;;) {
      ++iterations_;
      const bool solved = step(factor * errors.cost);
      if (solved && s_.dq.lpNorm<Eigen::Infinity>() <= 1e-15) return IkStop::Stalled;
      if (solved) {
        const double drop = predictedReduction();
        integrate(model_, s_.at, s_.dq, s_.next);
        clamp(s_.next);
        s_.r.head(rows_) = s_.e.head(rows_);
        const IkErrors found = evaluate(s_.next);
        if (found.cost < errors.cost) {
          const double gain = (errors.cost - found.cost) / std::max(drop, 1e-300);
          factor *= std::clamp(1 - std::pow(2 * gain - 1, 3), 1.0 / 3, 2.0);
          growth = 2;
          errors = found;
          s_.at.swap(s_.next);
          linearise();
          break;
        }
        s_.e.head(rows_) = s_.r.head(rows_);
      }
      factor *= growth;
      growth *= 2;
      if (!std::isfinite(growth)) return IkStop::Stalled;
    }
  }
  return converged(errors) ? IkStop::Converged : IkStop::IterationsUsedUp;
}

void IkSearch::relax(IkErrors& errors) {
  // the weighted square of the distance to rest; s.dq_preferred becomes the weighted difference to it
  const auto away = [&](const Eigen::VectorXd& q) {
    difference(model_, q, options_.rest, s_.dq_preferred);
    if (options_.rest_weight.size() == 0) return s_.dq_preferred.squaredNorm();
    double sum = 0;
    for (Eigen::Index k = 0; k < model_.nv; ++k) {
      sum += options_.rest_weight[k] * s_.dq_preferred[k] * s_.dq_preferred[k];
      s_.dq_preferred[k] *= options_.rest_weight[k];
    }
    return sum;
  };
  s_.kept = s_.at;
  IkErrors kept = errors;
  double nearest = away(s_.kept);
  double step_fraction = 1;  // of a full step
  for (int n = 0; n < options_.iterations && step_fraction > 1e-3; ++n) {
    s_.at = s_.kept;
    (void)evaluate(s_.at);
    linearise();
    (void)away(s_.at);
    s_.dq_preferred *= step_fraction;
    ++iterations_;
    if (!step(1e-10 * size_) || s_.dq.lpNorm<Eigen::Infinity>() <= 1e-6 * step_fraction) break;
    integrate(model_, s_.at, s_.dq, s_.next);
    clamp(s_.next);
    s_.at.swap(s_.next);
    // back onto the targets; what that costs is part of the step
    const bool met = reach(errors) == IkStop::Converged;
    const double now = met ? away(s_.at) : kInfinity;
    if (now < nearest) {
      nearest = now;
      s_.kept = s_.at;
      kept = errors;
      step_fraction = std::min(1.0, 2 * step_fraction);
    } else {
      step_fraction /= 2;
    }
  }
  s_.at = s_.kept;
  errors = kept;
}

JointIndex IkSearch::limit() const {
  JointIndex worst = 0;
  double largest = 1e-6 * std::sqrt(size_) * s_.e.head(rows_).norm();
  for (JointIndex j = 1; j < model_.njoints; ++j) {
    const JointModel& joint = model_.joints[j];
    double beyond = 0;
    if (isVectorSpace(joint.manifold())) {
      for (int k = joint.idx_v(); k < joint.idx_v() + joint.nv(); ++k)
        if (blocked(k)) beyond = std::max(beyond, std::abs(s_.gradient[k]));
    } else {
      bool stands = false;
      for (int k = joint.idx_q(); k < joint.idx_q() + joint.nq(); ++k)
        stands |= s_.at[k] <= model_.lowerPositionLimit[k] || s_.at[k] >= model_.upperPositionLimit[k];
      if (stands) beyond = s_.gradient.segment(joint.idx_v(), joint.nv()).norm();
    }
    if (beyond > largest) {
      worst = j;
      largest = beyond;
    }
  }
  return worst;
}

}  // namespace rbd::inner
