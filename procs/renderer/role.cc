#include "procs/renderer/role.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <lab/end_t.hpp>
#include <lab/frame_t.hpp>
#include <lab/need_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>

#include "procs/experiment/experiment_yaml.h"
#include "procs/wire/guard.h"
#include "procs/wire/step_record.h"
#include "render/png.h"
#include "procs/wire/codec.h"
#include "procs/wire/convert.h"
#include "procs/wire/log_writer.h"
#include "procs/wire/participant.h"

namespace lab::renderer {

Watcher::Watcher(Experiment settings, std::string run_dir, Publish publish)
    : settings_(std::move(settings)), run_dir_(std::move(run_dir)), publish_(std::move(publish)) {}

std::string Watcher::state() const {
  if (outcome_.exit_code != kOk) return "FAULT";
  if (run_ == 0) return "STARTING";
  return drawn_ < 0 ? "READY" : "RUNNING";
}

void Watcher::receive(Channel channel, std::span<const uint8_t> bytes, Micros) try {
  if (outcome_.ended) return;
  silence_.progress();
  if (channel == Channel::Run && run_ == 0) return on_run(bytes);
  if (run_ == 0 || peek_run(bytes) != run_) return;
  if (channel == Channel::RobotState) {
    const int64_t step = peek_step(bytes);
    if (realtime_) {
      const auto gap = static_cast<int64_t>(std::ceil(1 / (settings_.renderer.fps * dt_)));
      if (drawn_ < 0 || step / gap > drawn_ / gap) states_.clear(), states_[step] = to_signal(decode<robot_state_t>(bytes)).q;
      return;
    }
    if (step > drawn_ && std::binary_search(wanted_.begin(), wanted_.end(), step) && !states_.contains(step))
      states_[step] = to_signal(decode<robot_state_t>(bytes)).q;
  } else if (channel == Channel::End && !last_step_) {
    last_step_ = decode<end_t>(bytes).step;
    if (!realtime_) wanted_ = steps_at_rate(settings_.renderer.fps, dt_, std::max<int64_t>(*last_step_, 0));
  }
} catch (const std::exception& error) {
  outcome_ = {true, kBadConfig, error.what()};
}

void Watcher::on_run(std::span<const uint8_t> bytes) {
  const auto message = decode<run_t>(bytes);
  Experiment experiment = parse_experiment(message.experiment, "RUN");
  robot_ = message.urdf.empty() ? load_robot(experiment) : load_robot(experiment, message.urdf, find_model(settings_));
  experiment.renderer = settings_.renderer;
  dt_ = experiment.simulator.dt;
  realtime_ = experiment.simulator.clock == "realtime";
  wanted_ = realtime_ ? std::vector<int64_t>{} : steps_at_rate(experiment.renderer.fps, dt_, experiment.last_step());
  painter_ = std::make_unique<Painter>(*robot_, experiment);
  for (const auto& warning : painter_->warnings()) fmt::print(stderr, "lab-renderer: warning: {}\n", warning);
  folder_ = std::make_unique<FrameFolder>(
      run_dir_ + "/frames",
      render::PngTexts{{"run", fmt::format("{:016x}", static_cast<uint64_t>(message.run))},
                       {"camera", experiment.renderer.camera},
                       {"renderer", painter_->gl_info()}});
  std::ofstream(run_dir_ + "/gl.txt") << painter_->gl_info() << '\n';
  run_ = message.run;
}

/// Takes RUN, states and END from the log as far as it is written: for what the bus did not bring.
void Watcher::read_more_of_the_log() {
  if (!log_) {
    const std::string final = run_dir_ + "/log.lcm", part = part_name(final);
    const std::string& path = std::filesystem::exists(final) ? final : part;
    if (!std::filesystem::exists(path)) return;
    log_ = std::make_unique<LogReader>(path);
  }
  static const Guard guard;
  for (LogEvent event; log_->next(event);) {
    const auto channel = channel_of(event.channel);
    if (channel && guard.check(*channel, event.data)) receive(*channel, event.data, 0);
    if (outcome_.ended) return;
  }
}

void Watcher::tick(Micros now) try {
  if (outcome_.ended) return;
  silence_.look(now);
  wake_ = now + kRepeat;
  const bool state_missing = run_ == 0 || (next_ < wanted_.size() && !states_.contains(wanted_[next_]));
  if (state_missing && now >= next_look_) next_look_ = now + kRepeat / 2, read_more_of_the_log();
  if (outcome_.ended || run_ == 0) {
    if (stopping_ || silence_.total() > std::llround(settings_.ready * 1e6))
      outcome_ = {true, stopping_ ? kOk : kNotReady, stopping_ ? "" : fmt::format("no RUN from the simulator in {:g} s", settings_.ready)};
    return;
  }
  if (realtime_ && !states_.empty() && !last_step_) {
    draw(states_.begin()->first);
  } else if (next_ < wanted_.size() && states_.contains(wanted_[next_])) {
    draw_next();
    wake_ = now;
  } else if (last_step_ && next_ >= wanted_.size()) {
    finish();
  } else if (stopping_ || silence_.total() > std::llround(settings_.deadline * 1e6)) {
    finish();  // the run broke off: what is drawn is what there is
  }
} catch (const std::exception& error) {
  outcome_ = {true, kDied, error.what()};
}

void Watcher::draw_next() {
  draw(wanted_[next_]);
  ++next_;
}

void Watcher::draw(int64_t step) {
  const double time = static_cast<double>(step_utime(step, dt_)) * 1e-6;
  const std::string path = folder_->write(painter_->draw(states_[step]), step, time);
  states_.erase(states_.begin(), states_.upper_bound(step));
  drawn_ = step;
  silence_.progress();

  frame_t frame{};
  frame.utime = wall_now(), frame.run = run_, frame.step = step;
  frame.path = "frames/" + std::filesystem::path(path).filename().string();
  frame.width = static_cast<int32_t>(settings_.renderer.size[0]), frame.height = static_cast<int32_t>(settings_.renderer.size[1]);
  frame.camera = settings_.renderer.camera;
  publish_(Channel::Frame, encode(frame));
}

void Watcher::finish() {
  folder_->write_contact_sheet(run_dir_ + "/contact.png");
  outcome_.ended = true;
}

void Watcher::stop(Micros) { stopping_ = true, next_look_ = 0; }

}  // namespace lab::renderer
