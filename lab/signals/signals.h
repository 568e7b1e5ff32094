#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

/// The plain values that steps take and give. A step knows these and the core, and nothing of LCM;
/// procs/wire turns them into messages and back. Vectors are in model order, SI units.
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

/// What a person or tool asks for, once the simulator has accepted it. See lcmtypes/action_t.lcm.
struct Action {
  std::string verb, target, key, text;
  std::vector<double> values;
};

/// Something worth a line in the log: what happened, to whom, why (the value seen and the bound).
struct Event {
  std::string what, who, why;
};

}  // namespace lab
