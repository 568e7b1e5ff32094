// Sensors: ROBOT_STATE holds what they measure: q and v, delayed by some steps, with noise.
#pragma once
#include <rbd/model/model.h>

#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab::simulator {

struct Sensors {
  struct Noisy {
    int joint = 0, q = 0, v = 0;  ///< joint index; its indices in q and v
    double q_deviation = 0, v_deviation = 0;
  };
  int64_t seed = 0;
  int64_t delay = 0;         ///< steps
  std::vector<Noisy> noisy;  ///< joints of one degree of freedom; others are measured exactly
  bool perfect() const { return delay == 0 && noisy.empty(); }
};

/// Throws ExperimentError: a delay too long, noise on a floating base, a log without every step (replay.h needs all).
Sensors make_sensors(const Experiment&, const rbd::Model&);

/// The newest true q and v, as many as the delay needs.
struct DelayBuffer {
  DelayBuffer(const Sensors&, const RobotState& first);
  void keep(const RobotState& truth);
  struct Sample {
    Eigen::VectorXd q, v;
  };
  std::vector<Sample> ring;  ///< step k at k mod size
};

/// q and v of `delay` steps ago (at least step 0) with the noise of this step; all other fields unchanged.
RobotState sense(const Sensors&, const DelayBuffer&, const RobotState& truth);

}  // namespace lab::simulator
