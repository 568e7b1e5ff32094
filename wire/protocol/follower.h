// The planner and the controller in the protocol: what lockstep and real time share. Both wait for RUN, then answer
// ROBOT_STATE with messages of their own until END.
#pragma once
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <memory>
#include <string>
#include <vector>

#include "lab/signals/signals.h"
#include "wire/protocol/input_queue.h"
#include "wire/protocol/role.h"

namespace lab {

/// What a process needs to know from RUN.
struct RunSetup {
  int64_t model_hash = 0;
  int nq = 0, nv = 0;
  double dt = 0;
  int64_t last_step = 0, lead = 0, every = 1;
  bool realtime = false;
  int64_t timeout = 0;  ///< real time: steps after which a reference is too old to follow
};
/// Prepares a process for a run: loads the model, reads the experiment. Throws std::exception with one line.
using BeginRun = std::function<RunSetup(const run_t&)>;
/// Calls visit for each message of the whole steps that the run's log has so far, in the log's order.
using ReadLog =
    std::function<void(int64_t run, const std::function<void(Channel, std::span<const uint8_t>)>& visit)>;

struct FollowerConfig {
  Micros deadline = 10'000'000, ready_deadline = 10'000'000;
  ReadLog read_log;  ///< lets a restarted process catch up in lockstep; may be empty
};

/// The messages for one step: events first, then the main message that counts them.
struct Answer {
  int64_t step = -1;
  std::vector<Bytes> events;
  Bytes main;
};

/// What a role and its FollowerRun share.
struct FollowerContext {
  std::string name;        ///< as in PROCESS
  Channel answer_channel;  ///< of the main messages
  Publish publish;
  RunSetup setup{};
  int64_t run = 0;  ///< 0 while unknown
  Outcome outcome{};
  IdleTimer idle_timer{};

  void fail(int exit_code, const std::string& reason) { outcome = {true, exit_code, reason}; }
  void publish_answer(const Answer& answer) const;
  /// Asks the simulator to re-send a step.
  void request(int64_t step) const;
  /// The EVENT messages of a step whose time is `utime`.
  std::vector<Bytes> encode_events(const std::vector<Event>& events, int64_t step, int64_t utime) const;
};

/// A follower's part in one run, from RUN to END: what depends on the clock (one subclass for each clock).
class FollowerRun {
 public:
  explicit FollowerRun(FollowerContext& context) : context_(context) {}
  virtual ~FollowerRun() = default;
  FollowerRun(const FollowerRun&) = delete;
  FollowerRun& operator=(const FollowerRun&) = delete;

  /// Called once, after RUN.
  virtual void start(const ReadLog& read_log, Micros now) = 0;
  virtual void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) = 0;
  /// The simulator has published its state, as in PROCESS.
  virtual void on_simulator_state(const std::string&) {}
  virtual void tick(Micros now) = 0;
  virtual Micros wake() const = 0;
  virtual Micros batch() const = 0;
  virtual int urgency() const = 0;
  virtual std::string state() const = 0;
  int64_t next() const { return next_; }
  int64_t late() const { return late_; }

 protected:
  const RunSetup& setup() const { return context_.setup; }

  FollowerContext& context_;
  InputQueue inputs_;
  robot_state_t state_;  ///< the current one; a member to reuse its memory
  int64_t next_ = 0;     ///< the step to handle next
  int64_t late_ = 0;     ///< messages for steps already handled
  RetryTimer retry_timer_;
};

using MakeFollowerRun = std::function<std::unique_ptr<FollowerRun>(FollowerContext&)>;

/// A process that follows the simulator: waits for RUN, then hands everything to the FollowerRun of the run's clock.
class FollowerRole : public Role {
 public:
  FollowerRole(std::string name, Channel answer, FollowerConfig config, BeginRun begin,
               MakeFollowerRun make_run, Publish publish);
  FollowerRole(const FollowerRole&) = delete;  // its FollowerRun refers to it
  FollowerRole& operator=(const FollowerRole&) = delete;

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void tick(Micros now) override;
  Micros wake() const override { return run_ ? run_->wake() : retry_timer_.due(); }
  Micros batch() const override { return run_ ? run_->batch() : 0; }
  int urgency() const override { return run_ ? run_->urgency() : 0; }
  void stop(Micros) override { context_.outcome.ended = true; }

  const Outcome& outcome() const override { return context_.outcome; }
  std::string state() const override;
  int64_t step() const override { return run_ ? run_->next() - 1 : -1; }
  int64_t run() const override { return context_.run; }
  int64_t model_hash() const override { return context_.setup.model_hash; }
  int nq() const override { return context_.setup.nq; }
  int nv() const override { return context_.setup.nv; }
  int64_t late() const override { return run_ ? run_->late() : 0; }

 private:
  void on_run(std::span<const uint8_t> bytes, Micros now);

  FollowerContext context_;
  FollowerConfig config_;
  BeginRun begin_;
  MakeFollowerRun make_run_;
  std::unique_ptr<FollowerRun> run_;  ///< null until RUN
  RetryTimer retry_timer_;            ///< for RUN
};

}  // namespace lab
