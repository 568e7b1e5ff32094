// Sensors: ROBOT_STATE is the true state as they measure it: q and v of some steps ago, with noise.
#pragma once
#include <rbd/model/model.h>

#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab::simulator {

struct Sensors {
  struct Noisy {
    int joint = 0, q = 0, v = 0;  ///< its number; its places in q and v
    double q_deviation = 0, v_deviation = 0;
  };
  int64_t seed = 0;
  int64_t delay = 0;         ///< steps
  std::vector<Noisy> noisy;  ///< joints of one degree of freedom; others are measured exactly
  bool perfect() const { return delay == 0 && noisy.empty(); }
};

/// Throws ExperimentError: a delay too long, noise for a floating base, a log with gaps, from which the true states could not be found.
Sensors make_sensors(const Experiment&, const rbd::Model&);

/// The last q and v, as many as the delay needs.
struct Memory {
  Memory(const Sensors&, const RobotState& first);
  void keep(const RobotState& truth);
  struct Moment {
    Eigen::VectorXd q, v;
  };
  std::vector<Moment> ring;  ///< step k at k mod size
};

/// q and v of `delay` steps ago (of step 0 before that) with the noise of this step; all else as it is.
RobotState sense(const Sensors&, const Memory&, const RobotState& truth);

}  // namespace lab::simulator
