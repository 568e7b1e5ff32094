// Whether a robot has arrived at a goal, from what its run publishes.
#pragma once
#include <rbd/algorithm/data.h>

#include <string>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab::send {

/// Follows one goal from its acceptance on. It is reached when the reference rests there and every joint of the robot is within
/// evaluation.band of it.
class Arrival {
 public:
  static constexpr double kSettles =
      5;  ///< s of simulated time that the robot has once the reference rests at the goal

  /// `step`: from which on the goal holds.
  Arrival(const Experiment&, const rbd::Model&, Action goal, int64_t step);

  void see(const Reference&);
  void see(const RobotState&);
  /// An action that was accepted after the goal.
  void see(const Action&);
  /// The goal will not be reached, because.
  void give_up(const std::string& why);

  bool over() const { return reached_ || !why_not_.empty(); }
  bool reached() const { return reached_; }
  int64_t step() const { return step_; }  ///< at which it was reached
  double seconds() const { return static_cast<double>(step_ - from_) * dt_; }
  /// Why the goal was not reached. While it is under way: how far the robot is.
  std::string why_not() const;

 private:
  bool at_goal(const Eigen::VectorXd& q);

  const rbd::Model model_;
  rbd::Data data_;
  const Action goal_;
  const double band_, dt_;
  const int64_t from_;
  int64_t step_;
  int64_t rests_ = -1;      ///< step since which the reference rests at the goal; -1: it does not
  Eigen::VectorXd target_;  ///< nq: where it rests
  std::string farthest_;    ///< joint of the robot, and how far it is
  std::string why_not_;
  bool reached_ = false;
};

}  // namespace lab::send
