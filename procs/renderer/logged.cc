#include "procs/renderer/logged.h"

#include <algorithm>
#include <lab/input_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>

#include "lab/experiment/experiment.h"
#include "wire/log/checked_log.h"
#include "wire/protocol/convert.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"

namespace lab::renderer {

Logged survey(const std::string& path) {
  Logged logged;
  logged.log = read_checked(path, [&](Channel channel, std::span<const uint8_t> data) {
    if (channel == Channel::Run) logged.run = decode<run_t>(data);
    if (channel == Channel::RobotState) logged.steps.push_back(peek_step(data));
    if (channel != Channel::Input) return;
    const auto input = decode<input_t>(data);
    const auto& values = input.action.values;  // torque, force, seconds
    if (input.action.verb != "push" || values.size() < 7) return;
    const double begin = static_cast<double>(input.utime) * 1e-6;
    logged.pushes.push_back(
        {begin, begin + values[6], input.action.target, {values[3], values[4], values[5]}});
  });
  if (logged.run.run == 0)
    throw ExperimentError(path + ": there is no RUN in this log, so the robot is not known");
  if (logged.steps.empty())
    throw ExperimentError(path + ": there is no ROBOT_STATE in this log, so there is nothing to draw");
  std::sort(logged.steps.begin(), logged.steps.end());
  return logged;
}

std::map<int64_t, Snapshot> read_snapshots(const std::string& path, const std::vector<int64_t>& steps,
                                           double dt) {
  std::map<int64_t, Snapshot> snapshots;
  read_checked(path, [&](Channel channel, std::span<const uint8_t> data) {
    if ((channel != Channel::RobotState && channel != Channel::Reference) ||
        !std::binary_search(steps.begin(), steps.end(), peek_step(data)))
      return;
    const int64_t step = peek_step(data);
    Snapshot& snapshot = snapshots[step];
    snapshot.step = step;
    snapshot.time = static_cast<double>(step_utime(step, dt)) * 1e-6;
    if (channel == Channel::Reference) {
      snapshot.reference = to_signal(decode<reference_t>(data)).q;
    } else {
      auto state = to_signal(decode<robot_state_t>(data));
      snapshot.q = std::move(state.q);
      snapshot.v = std::move(state.v);
    }
  });
  std::erase_if(snapshots, [](const auto& each) { return each.second.q.size() == 0; });
  return snapshots;
}

}  // namespace lab::renderer
