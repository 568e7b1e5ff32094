#include "procs/renderer/from_log.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <map>

#include "procs/experiment/experiment_yaml.h"
#include "procs/renderer/frames.h"
#include "procs/renderer/painter.h"
#include "procs/wire/codec.h"
#include "procs/wire/convert.h"
#include "procs/wire/guard.h"
#include "procs/wire/log_reader.h"
#include "procs/wire/log_writer.h"
#include "procs/wire/role.h"

namespace lab::renderer {
namespace {

namespace fs = std::filesystem;

struct Logged {
  run_t run{};
  std::map<int64_t, Eigen::VectorXd> states;
};

Logged read_log(const std::string& path) {
  Logged logged;
  LogReader reader(path);
  const Guard guard;
  for (LogEvent event; reader.next(event);) {
    const auto channel = channel_of(event.channel);
    if (!channel || !guard.check(*channel, event.data)) continue;
    if (*channel == Channel::Run) logged.run = decode<run_t>(event.data);
    if (*channel == Channel::RobotState) {
      const auto state = decode<robot_state_t>(event.data);
      logged.states[state.step] = to_signal(state).q;
    }
  }
  if (logged.run.run == 0) throw ExperimentError(path + ": there is no RUN in this log, so the robot is not known");
  if (logged.states.empty()) throw ExperimentError(path + ": there is no ROBOT_STATE in this log, so there is nothing to draw");
  return logged;
}

std::string find_log(const std::string& source) {
  if (!fs::is_directory(source)) return source;
  const std::string log = source + "/log.lcm";
  if (!fs::exists(log) && fs::exists(part_name(log))) return part_name(log);
  return log;
}

}  // namespace

int render_log(const FromLog& job) {
  const std::string path = find_log(job.source);
  const Logged logged = read_log(path);
  Experiment experiment = parse_experiment(logged.run.experiment, "RUN in " + path);
  const std::string beside = (fs::absolute(path).parent_path() / "experiment.yaml").string();
  std::string meshes = "RUN";
  if (fs::exists(beside)) {
    const Experiment as_run = load_experiment(beside);
    experiment.renderer = as_run.renderer;
    if (!logged.run.urdf.empty()) meshes = find_model(as_run);
  }
  const Robot robot = logged.run.urdf.empty() ? load_robot(experiment) : load_robot(experiment, logged.run.urdf, meshes);
  if (job.width) experiment.renderer.size = {job.width, job.height};
  if (!job.camera.empty()) experiment.renderer.camera = job.camera;
  if (!job.quality.empty()) experiment.renderer.quality = job.quality;

  const double dt = experiment.simulator.dt;
  const int64_t last_step = logged.states.rbegin()->first;
  std::vector<int64_t> steps;
  for (double time : job.times) {
    const int64_t step = std::llround(time / dt);
    if (!(time >= 0) || step > last_step)
      throw ExperimentError(fmt::format("--times: {} s is outside the run, which lasts from 0 to {} s", number(time), number(static_cast<double>(last_step) * dt)));
    steps.push_back(step);
  }
  if (steps.empty()) steps = steps_at_rate(job.fps.value_or(experiment.renderer.fps), dt, last_step);

  Painter painter(robot, experiment);
  for (const auto& warning : painter.warnings()) fmt::print(stderr, "lab-renderer: warning: {}\n", warning);
  FrameFolder folder(job.folder, {{"run", fmt::format("{:016x}", static_cast<uint64_t>(logged.run.run))},
                                  {"camera", experiment.renderer.camera},
                                  {"renderer", painter.gl_info()}});
  const bool progress = isatty(STDERR_FILENO) && steps.size() > 10;
  for (int64_t step : steps) {
    const auto state = logged.states.find(step);
    if (state == logged.states.end()) {
      fmt::print(stderr, "lab-renderer: step {} is missing in {}; no picture of it\n", step, path);
      continue;
    }
    const std::string file = folder.write(painter.draw(state->second), step, static_cast<double>(step) * dt);
    if (progress) fmt::print(stderr, "\r{} of {} pictures ", folder.count(), steps.size());
    else fmt::print("{}\n", file);
  }
  if (progress) fmt::print(stderr, "\n");
  if (folder.count() > 1) {
    folder.write_contact_sheet(job.folder + "/contact.png");
    fmt::print("{}/contact.png\n", job.folder);
  }
  return kOk;
}

}  // namespace lab::renderer
