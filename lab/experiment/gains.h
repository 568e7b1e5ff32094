// The table of the controller's gains. A new gain is one member and one row here: the experiment's key, its docs, the
// check and effect of `set controller KEY=..` (live_gains.cc) and the member of State::gains that a law reads all come
// from it.
#pragma once
#include <array>

#include "lab/experiment/key.h"

namespace lab {

/// `PerJoint`: JointValues in an experiment, Eigen::VectorXd (nv) in a controller.
template <class PerJoint>
struct GainValues {
  PerJoint kp, kd;
  std::array<double, 2> stiffness{}, damping{};  ///< of a frame: angular, linear
  double com_gain = 0;                           ///< 1/s
  bool operator==(const GainValues&) const = default;
};

/// Calls f(key, member of each of `gains`) for the gains on the joints.
template <class F, class... Gains>
void for_each_joint_gain(F&& f, Gains&... gains) {
  f(Key{"controller.kp", "pd: Nm/rad, N/m; computed_torque: 1/s2; com_velocity: 1/s", "0",
        "gain on the error of q", 0},
    gains.kp...);
  f(Key{"controller.kd", "pd: Nm s/rad, N s/m; computed_torque, com_velocity: 1/s", "0",
        "gain on the error of v", 0},
    gains.kd...);
}

/// The same for the gains on a task.
template <class F, class... Gains>
void for_each_task_gain(F&& f, Gains&... gains) {
  f(Key{"controller.stiffness", "Nm/rad, N/m", "[0, 0]",
        "cartesian_impedance: of the frame, angular and linear; a part with neither stiffness nor damping is "
        "left to the posture (`kp`, `kd`)",
        0},
    gains.stiffness...);
  f(Key{"controller.damping", "Nm s/rad, N s/m", "[0, 0]",
        "cartesian_impedance: of the frame, angular and linear", 0},
    gains.damping...);
  f(Key{"controller.com_gain", "1/s", "0", "com_velocity: gain on the error of the centre of mass", 0},
    gains.com_gain...);
}

template <class F, class... Gains>
void for_each_gain(F&& f, Gains&... gains) {
  for_each_joint_gain(f, gains...);
  for_each_task_gain(f, gains...);
}

}  // namespace lab
