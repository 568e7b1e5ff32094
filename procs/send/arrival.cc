#include "procs/send/arrival.h"

#include <fmt/format.h>
#include <rbd/algorithm/kinematics.h>

#include "lab/experiment/cartesian.h"
#include "lab/experiment/joints.h"

namespace lab::send {

Arrival::Arrival(const Experiment& e, const rbd::Model& model, Action goal, int64_t step)
    : model_(model),
      data_(model_),
      goal_(std::move(goal)),
      band_(e.evaluation.band),
      dt_(e.simulator.dt),
      from_(step),
      step_(step) {}

bool Arrival::at_goal(const Eigen::VectorXd& q) {
  constexpr double kSame = 1e-5;  // rad, m: ten times what the inverse kinematics may leave
  if (q.size() != model_.nq) return false;
  if (!is_cartesian(goal_))
    return (q - Eigen::Map<const Eigen::VectorXd>(goal_.values.data(), model_.nq)).cwiseAbs().maxCoeff() <
           kSame;
  rbd::forwardKinematics(model_, data_, q);
  const rbd::SE3& pose = data_.oMf[model_.frameId(goal_.target)];
  const std::vector<double>& x = goal_.values;
  if ((pose.translation() - Eigen::Vector3d(x[0], x[1], x[2])).norm() > kSame) return false;
  return x.size() < 7 ||
         Eigen::Quaterniond(pose.rotation()).angularDistance(Eigen::Quaterniond(x[6], x[3], x[4], x[5])) <
             kSame;
}

void Arrival::see(const Reference& reference) {
  if (over() || reference.step < from_) return;
  if (!reference.v.isZero(0) || !at_goal(reference.q)) {
    rests_ = -1;
  } else if (rests_ < 0) {
    rests_ = reference.step;
    target_ = reference.q;
  }
}

void Arrival::see(const RobotState& state) {
  if (over() || rests_ < 0 || state.step < rests_ || state.q.size() != target_.size()) return;
  Eigen::Index worst = 0;
  const double distance = (state.q - target_).cwiseAbs().maxCoeff(&worst);
  step_ = state.step;
  reached_ = distance <= band_;
  farthest_ =
      fmt::format("joint '{}' is {:.3g} from it", joint_at(model_, static_cast<int>(worst)), distance);
  if (!reached_ && static_cast<double>(state.step - rests_) * dt_ > kSettles)
    give_up(fmt::format("{} {:g} s after the reference has arrived", farthest_, kSettles));
}

void Arrival::see(const Action& action) {
  if (action.verb == "goal") give_up("another goal has taken its place");
  if (action.verb == "set" && action.target == "planner") give_up("the planner is back at its motion");
}

void Arrival::give_up(const std::string& why) {
  if (!over()) why_not_ = why;
}

std::string Arrival::why_not() const {
  if (!why_not_.empty()) return why_not_;
  return farthest_.empty() ? "the reference has not arrived there" : farthest_;
}

}  // namespace lab::send
