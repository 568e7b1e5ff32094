#include "procs/renderer/role.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <lab/end_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>

#include "core/util/console.h"
#include "lab/experiment/experiment_yaml.h"
#include "render/png.h"
#include "wire/log/log_writer.h"
#include "wire/process/participant.h"
#include "wire/protocol/convert.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/codec.h"
#include "wire/schema/guard.h"

namespace lab::renderer {

RendererRole::RendererRole(Experiment settings, std::string run_dir, Publish publish)
    : settings_(std::move(settings)), run_dir_(std::move(run_dir)), publish_(std::move(publish)) {}

std::string RendererRole::state() const {
  if (outcome_.exit_code != kOk) return "FAULT";
  if (run_ == 0) return "STARTING";
  return drawn_ < 0 ? "READY" : "RUNNING";
}

void RendererRole::receive(Channel channel, std::span<const uint8_t> bytes, Micros) try {
  if (outcome_.ended) return;
  idle_timer_.reset();
  if (channel == Channel::Run && run_ == 0) return on_run(bytes);
  if (run_ == 0 || peek_run(bytes) != run_) return;
  if (channel == Channel::RobotState)
    on_state(peek_step(bytes), bytes);
  else if (channel == Channel::Reference)
    on_reference(peek_step(bytes), bytes);
  else if (channel == Channel::End && !last_step_)
    on_end(bytes);
} catch (const std::exception& error) {
  outcome_ = {true, kBadConfig, error.what()};
}

void RendererRole::on_state(int64_t step, std::span<const uint8_t> bytes) {
  const auto snapshot = [&] {
    const RobotState state = to_signal(decode<robot_state_t>(bytes));
    return Snapshot{step, static_cast<double>(step_utime(step, dt_)) * 1e-6, state.q, state.v, {}};
  };
  if (realtime_) {
    if (scene_->needs_samples() && step / sample_gap_ > sampled_ / sample_gap_) {
      scene_->remember(snapshot());
      sampled_ = step;
    }
    const auto gap = static_cast<int64_t>(std::ceil(1 / (settings_.renderer.fps * dt_)));
    if (drawn_ < 0 || step / gap > drawn_ / gap) {
      snapshots_.clear();
      snapshots_[step] = snapshot();
    }
    return;
  }
  if (next_ >= needed_.size() || step < needed_[next_] ||
      !std::binary_search(needed_.begin(), needed_.end(), step))
    return;
  Snapshot& kept = snapshots_[step];
  if (kept.q.size() > 0) return;
  Eigen::VectorXd reference = std::move(kept.reference);  // it may have come first
  kept = snapshot();
  kept.reference = std::move(reference);
}

void RendererRole::on_reference(int64_t step, std::span<const uint8_t> bytes) {
  if (!settings_.renderer.reference) return;
  const auto q = [&] { return to_signal(decode<reference_t>(bytes)).q; };
  if (realtime_) {
    references_[step] = q();
    if (references_.size() > static_cast<size_t>(2 * kWindow)) references_.erase(references_.begin());
  } else if (next_ < needed_.size() && step >= needed_[next_] &&
             std::binary_search(pictures_.begin(), pictures_.end(), step)) {
    snapshots_[step].reference = q();
  }
}

void RendererRole::on_end(std::span<const uint8_t> bytes) {
  last_step_ = decode<end_t>(bytes).step;
  if (!realtime_) plan(std::max<int64_t>(*last_step_, 0));
}

/// The needed steps from 0 to last_step. What has been done of a longer plan stays done: both begin with the same steps.
void RendererRole::plan(int64_t last_step) {
  pictures_ = steps_at_rate(settings_.renderer.fps, dt_, last_step);
  needed_ = pictures_;
  if (scene_->needs_samples())
    for (int64_t step = 0; step < last_step; step += sample_gap_) needed_.push_back(step);
  std::sort(needed_.begin(), needed_.end());
  needed_.erase(std::unique(needed_.begin(), needed_.end()), needed_.end());
}

bool RendererRole::ready(int64_t step) const {
  const auto found = snapshots_.find(step);
  if (found == snapshots_.end() || found->second.q.size() == 0) return false;
  return !settings_.renderer.reference || found->second.reference.size() > 0 ||
         !std::binary_search(pictures_.begin(), pictures_.end(), step);
}

void RendererRole::on_run(std::span<const uint8_t> bytes) {
  const auto message = decode<run_t>(bytes);
  Experiment experiment = parse_experiment(message.experiment, "RUN");
  robot_ = message.urdf.empty() ? load_robot(experiment)
                                : load_robot(experiment, message.urdf, find_model(settings_));
  experiment.renderer = settings_.renderer;
  dt_ = experiment.simulator.dt;
  sample_gap_ = sample_gap(experiment);
  sampled_ = -sample_gap_;
  realtime_ = experiment.simulator.clock == "realtime";
  scene_ = std::make_unique<RunScene>(*robot_, experiment);
  for (const auto& warning : scene_->warnings()) say("lab-renderer: warning: {}", warning);
  if (!realtime_) plan(experiment.last_step());
  painter_ = std::make_unique<Painter>(*scene_);
  about_ = {{"run", fmt::format("{:016x}", static_cast<uint64_t>(message.run))},
            {"renderer", painter_->gl_info()}};
  folder_ = std::make_unique<FrameFolder>(run_dir_ + "/frames", about_);
  std::ofstream(run_dir_ + "/gl.txt") << painter_->gl_info() << '\n';
  run_ = message.run;
}

/// Takes RUN, states and END from the log as far as it is written: those that were missed on the bus.
void RendererRole::read_more_of_the_log() {
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

void RendererRole::tick(Micros now) try {
  if (outcome_.ended) return;
  idle_timer_.update(now);
  wake_ = now + kRepeat;
  const bool state_missing = run_ == 0 || (next_ < needed_.size() && !ready(needed_[next_]));
  if (state_missing && now >= next_look_) {
    next_look_ = now + kRepeat / 2;
    read_more_of_the_log();
  }
  if (outcome_.ended || run_ == 0) {
    if (stopping_ || idle_timer_.elapsed() > std::llround(settings_.ready * 1e6))
      outcome_ = {true, stopping_ ? kOk : kNotReady,
                  stopping_ ? "" : fmt::format("no RUN from the simulator in {:g} s", settings_.ready)};
    return;
  }
  publish_written();
  if (realtime_ && !snapshots_.empty() && !last_step_) {
    Snapshot snapshot = std::move(snapshots_.begin()->second);
    snapshots_.clear();
    if (const auto after = references_.upper_bound(snapshot.step); after != references_.begin())
      snapshot.reference = std::prev(after)->second;
    draw(snapshot);
  } else if (next_ < needed_.size() && ready(needed_[next_])) {
    do_next();
    wake_ = now;
  } else {
    const bool all_drawn = last_step_ && next_ >= needed_.size();
    // the run broke off: what is drawn is what there is
    const bool broken_off = stopping_ || idle_timer_.elapsed() > std::llround(settings_.deadline * 1e6);
    if (all_drawn || broken_off) finish();
  }
} catch (const std::exception& error) {
  outcome_ = {true, kDied, error.what()};
}

void RendererRole::do_next() {
  const int64_t step = needed_[next_++];
  const Snapshot snapshot = std::move(snapshots_[step]);
  snapshots_.erase(snapshots_.begin(), snapshots_.upper_bound(step));
  const bool picture = std::binary_search(pictures_.begin(), pictures_.end(), step);
  if (scene_->needs_samples() && (step % sample_gap_ == 0 || step == pictures_.back()))
    scene_->remember(snapshot);
  if (picture) draw(snapshot);
  idle_timer_.reset();
}

void RendererRole::draw(const Snapshot& snapshot) {
  const auto index = static_cast<int64_t>(times_.size());
  folder_->write(index, painter_->draw(scene_->shot(snapshot)));
  times_.push_back(snapshot.time);
  drawn_ = snapshot.step;
  idle_timer_.reset();

  frame_t frame{};
  frame.run = run_;
  frame.step = snapshot.step;
  frame.path = "frames/" + std::filesystem::path(frame_path("", index)).filename().string();
  frame.width = static_cast<int32_t>(settings_.renderer.size[0]);
  frame.height = static_cast<int32_t>(settings_.renderer.size[1]);
  frame.camera = settings_.renderer.camera;
  unpublished_.push_back(frame);
}

/// FRAME for each picture that is on the disk by now.
void RendererRole::publish_written() {
  const auto waiting = static_cast<size_t>(static_cast<int64_t>(times_.size()) - folder_->done());
  for (; unpublished_.size() > waiting; unpublished_.pop_front()) {
    unpublished_.front().utime = wall_now();
    publish_(Channel::Frame, encode(unpublished_.front()));
  }
}

void RendererRole::finish() {
  folder_->finish();
  publish_written();
  write_contact_sheet_of(run_dir_ + "/contact.png", run_dir_ + "/frames", times_);
  if (settings_.renderer.ghost > 0 && drawn_ >= 0) {
    Picture picture = painter_->draw(scene_->ghosts(settings_.renderer.ghost));
    picture.texts.insert(picture.texts.begin(), about_.begin(), about_.end());
    render::write_png(run_dir_ + "/ghost.png", picture.image, picture.texts);
  }
  outcome_.ended = true;
}

void RendererRole::stop(Micros) {
  stopping_ = true;
  next_look_ = 0;
}

}  // namespace lab::renderer
