// The plain values that steps take and give. A step knows these and the core, and nothing of LCM;
// wire/protocol turns them into messages and back. Vectors are in model order, SI units.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace lab {

/// The robot as simulated at one step.
struct RobotState {
  int64_t step = 0;
  double time = 0;      ///< s, step * dt
  Eigen::VectorXd q;    ///< nq: configuration
  Eigen::VectorXd v;    ///< nv: velocity
  Eigen::VectorXd tau;  ///< nv: commanded and limited effort over the step that led here (0 at step 0)
};

/// What is wanted for one step.
struct Reference {
  int64_t step = 0;
  Eigen::VectorXd q;  ///< nq
  Eigen::VectorXd v;  ///< nv
  Eigen::VectorXd a;  ///< nv
};

/// Joint effort.
struct Command {
  Eigen::VectorXd tau;      ///< nv
  int64_t state_step = -1;  ///< of the state that it was made from
};

/// A request of a person or tool that the simulator has accepted. See lcmtypes/action_t.lcm.
struct Action {
  std::string verb, target, key, text;
  std::vector<double> values;
};

/// A line for the log: what happened, to what (a joint, a process), why (the value seen and the bound).
struct Event {
  std::string what, who, why;
};

}  // namespace lab
