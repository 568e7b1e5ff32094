// Replays a run from its logged inputs, step by step: the true states behind the sensor values, and the energy that pushes,
// payloads and soft stops added or removed.
#pragma once
#include <span>

#include "procs/simulator/simulator.h"

namespace lab::simulator {

/// The true states behind logged ones, by stepping the simulator through the logged inputs.
class TrueStates {
 public:
  explicit TrueStates(const Config& config) : config_(config), state_(initial(config)) {}

  /// Of the next step, from step 0 on. `command`: new at that step, or null; `actions` that led to it. Throws
  /// std::runtime_error if a step is missing or a replayed sensor value differs from the logged one in any bit.
  RobotState next(const RobotState& logged, const Command* command, std::span<const Action> actions);

 private:
  const Config& config_;
  State state_;
  int64_t next_step_ = 0;
};

/// Energy that is not the nominal robot's own: of pushes, payloads and soft stops.
class ExternalEnergy {
 public:
  explicit ExternalEnergy(const Config&);

  struct Step {
    double stored = 0;  ///< J: of the payloads, and in the soft stops
    /// J, over the step to this state: work of pushes plus energy of new payloads minus losses in soft stops. Work of a
    /// torque and losses by the trapezoidal rule, all else exact.
    double work = 0;
  };
  /// Of the next true state, from step 0 on, with the actions that led to it. After a gap all is 0.
  Step next(const RobotState&, std::span<const Action> actions);

 private:
  /// Poses and velocities of frames at one state.
  struct FrameView {
    const rbd::Model& model;
    rbd::Data data;
    explicit FrameView(const rbd::Model& m) : model(m), data(m) {}
    void set(const RobotState& s);
    const rbd::SE3& pose(rbd::FrameIndex frame);
    rbd::Motion velocity(rbd::FrameIndex frame);
  };
  static double payload_energy(FrameView& now, const Load& load);
  double work_to(const RobotState& state, std::span<const Action> actions);

  const Config& config_;
  Load load_;
  FrameView before_, after_;  ///< before_: at last_
  RobotState last_;
  int64_t next_step_ = 0;
  bool disturbed_;  ///< so far
};

}  // namespace lab::simulator
