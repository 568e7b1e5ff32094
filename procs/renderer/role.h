// The renderer as a participant of a run: draws pictures while the run goes on.
#pragma once
#include <deque>
#include <lab/frame_t.hpp>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "procs/renderer/frames.h"
#include "procs/renderer/painter.h"
#include "wire/log/log_reader.h"
#include "wire/protocol/role.h"

namespace lab::renderer {

/// It sends no ACK and no process waits for it: it keeps the states that become pictures or parts of traces, from the
/// bus as they arrive and from the log where some were missed, and draws one picture at each tick until all are drawn.
/// The pictures are a function of the logged steps. Files are written by another thread.
class RendererRole : public Role {
 public:
  /// `settings` holds the renderer's own keys, which RUN does not carry; the rest comes from RUN.
  RendererRole(Experiment settings, std::string run_dir, Publish publish);

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void tick(Micros now) override;
  Micros wake() const override { return wake_; }
  Micros batch() const override { return 500; }
  void stop(Micros now) override;

  const Outcome& outcome() const override { return outcome_; }
  std::string state() const override;
  int64_t step() const override { return drawn_; }
  int64_t run() const override { return run_; }
  int64_t model_hash() const override { return robot_ ? robot_->hash : 0; }
  int nq() const override { return robot_ ? static_cast<int>(robot_->model.nq) : 0; }
  int nv() const override { return robot_ ? static_cast<int>(robot_->model.nv) : 0; }

 private:
  void on_run(std::span<const uint8_t> bytes);
  void on_state(int64_t step, std::span<const uint8_t> bytes);
  void on_reference(int64_t step, std::span<const uint8_t> bytes);
  void on_end(std::span<const uint8_t> bytes);
  void plan(int64_t last_step);
  bool ready(int64_t step) const;
  void read_more_of_the_log();
  void do_next();
  void draw(const Snapshot&);
  void publish_written();
  void finish();

  Experiment settings_;
  std::string run_dir_;
  Publish publish_;
  Outcome outcome_;

  int64_t run_ = 0;
  double dt_ = 0;
  int64_t sample_gap_ = 1;
  std::optional<Robot> robot_;
  std::unique_ptr<RunScene> scene_;
  std::unique_ptr<Painter> painter_;
  std::unique_ptr<FrameFolder> folder_;
  render::PngTexts about_;
  bool realtime_ = false;          ///< at each tick draws the newest state and skips others
  std::vector<int64_t> pictures_;  ///< steps to draw, rising; none in real time
  std::vector<int64_t> needed_;    ///< these and the samples of traces and ghosts, rising
  size_t next_ = 0;                ///< index into needed_
  std::map<int64_t, Snapshot>
      snapshots_;  ///< those of the needed steps that have arrived; real time: the newest state
  std::map<int64_t, Eigen::VectorXd>
      references_;                   ///< real time: the newest ones, which run ahead of the states
  std::vector<double> times_;        ///< of the pictures drawn, s
  std::deque<frame_t> unpublished_;  ///< FRAME of pictures that may not be written yet
  int64_t drawn_ = -1, sampled_ = 0;
  std::optional<int64_t> last_step_;  ///< from END
  bool stopping_ = false;
  std::unique_ptr<LogReader> log_;
  Micros wake_ = 0, next_look_ = 0;
  IdleTimer idle_timer_;
};

}  // namespace lab::renderer
