// The simulator in the protocol, whatever its clock: start, requests and end of a run.
#pragma once
#include <lab/process_t.hpp>
#include <lab/request_t.hpp>
#include <lab/robot_state_t.hpp>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "lab/signals/signals.h"
#include "wire/protocol/reply_cache.h"
#include "wire/protocol/role.h"

namespace lab {

struct SimulatorConfig {
  Bytes run;                 ///< the encoded RUN message
  std::vector<Bytes> types;  ///< the encoded TYPE messages, for programs that come late; may be empty
  int64_t run_id = 0, model_hash = 0;
  int nq = 0, nv = 0;
  double dt = 0;          ///< s
  int64_t last_step = 0;  ///< N
  int64_t every = 1;      ///< lockstep: a COMMAND is due at every multiple of this
  int64_t lead = 0;       ///< lockstep: steps that the planner may be ahead
  Micros wall_offset =
      0;  ///< wall clock minus the caller's clock; 0 = not known: a request's age is not checked
  std::vector<std::string> required = {kPlanner, kController, kLogger};  ///< must be READY before step 0
  std::vector<std::string> listeners = {kLogger};                        ///< the end waits for their last ACK
  Micros deadline = 10'000'000, ready_deadline = 10'000'000;
  /// Why a requested action is refused; empty = it is accepted. `newest` is the reference that reaches farthest ahead, null
  /// before the first. May be null.
  std::function<std::string(const Action&, const Reference* newest)> why_not{};
  /// The answer to `get`: what is in force, lines "name<tab>value<tab>unit". May be null.
  std::function<std::string()> in_force{};
  /// Why a requested `reset` is refused; empty = it is accepted: this run ends and the supervisor starts the next.
  std::string no_reset{};
};

/// The result of one step of the simulator.
struct StepResult {
  RobotState state;
  std::vector<Event> events;
  std::string abort;  ///< not empty: the state cannot be published, the run ends with a safety stop
  std::string mode = "RUNNING";  ///< RUNNING, HOLDING, FAULT, as in PROCESS
};
/// Makes the state of `step` from the one before. `command` is null when none is new; actions take effect from this step on.
using SimulateStep =
    std::function<StepResult(int64_t step, const Command* command, std::span<const Action> actions)>;

/// The simulator's side of a run with either clock: waits for the required processes, answers requests and ends the
/// run. LockstepSimulatorRole and RealtimeSimulatorRole decide when a step is taken.
class SimulatorRole : public Role {
 public:
  static constexpr size_t kMaxInputs = 64;              ///< INPUTs for one step; more requests are refused
  static constexpr Micros kMaxRequestAge = 10'000'000;  ///< us, either way
  static constexpr Micros kNeighbourStays =
      1'000'000;                                 ///< us: so long after its last PROCESS it counts as there
  static constexpr Micros kRunAgain = 20'000;    ///< us between two answers to NEED(-1)
  static constexpr Micros kIntroduce = 150'000;  ///< us between two repetitions, of RUN and each TYPE in turn
  static constexpr int64_t kMaxSingleSteps = 1'000'000'000;
  static constexpr size_t kMaxSender = 256, kMaxReason = 1000;  ///< characters
  static constexpr size_t kMaxAnswer = 12'000;                  ///< of `get`

  SimulatorRole(SimulatorConfig config, SimulateStep simulate, Publish publish);

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void neighbour(Micros now) override { neighbour_heard_ = now; }
  void tick(Micros now) override;
  Micros wake() const override;
  void stop(Micros now) override;

  const Outcome& outcome() const override { return outcome_; }
  std::string state() const override;
  int64_t step() const override { return published_; }
  int64_t run() const override { return config_.run_id; }
  int64_t model_hash() const override { return config_.model_hash; }
  int nq() const override { return config_.nq; }
  int nv() const override { return config_.nv; }
  /// us from the first ROBOT_STATE to END.
  Micros running_time() const { return ended_at_ - started_at_; }
  /// True if this run ends because a new one was requested.
  bool restart_requested() const { return restart_requested_; }

 protected:
  enum class Phase { Gathering, Running, Ending, Over };

  // the part that depends on the clock
  virtual void on_message(Channel channel, std::span<const uint8_t> bytes, Micros now) = 0;
  virtual void on_ack(const std::string&, int64_t /*complete_to*/) {}
  virtual void on_need(int64_t step, Micros now) = 0;
  virtual void on_input(int64_t step, const Bytes& input) = 0;  ///< keeps it for processes that ask again
  virtual void on_resume(Micros) {}
  virtual std::span<const uint8_t> newest_reference() = 0;  ///< an encoded REFERENCE; empty before the first
  virtual void on_reset(const std::string& /*sender*/) {}   ///< ends the run soon
  virtual void begin(Micros now) = 0;                       ///< all processes are READY: step 0
  virtual void take_due_steps(Micros now) = 0;              ///< takes the steps that are possible now
  virtual Micros next_wake() const = 0;                     ///< while running
  virtual int64_t utime(int64_t step) const = 0;
  virtual int64_t digest_of_last() { return 0; }

  using Put = std::function<void(Channel, const Bytes&)>;
  /// Makes the messages of a step's state, extras first. The caller has set digest and command_step in `message`.
  void compose(const StepResult& result, int64_t step, robot_state_t& message, const Put& put);
  void publish_run_again(Micros now);
  void end(bool aborted, const std::string& reason, Micros now);
  void fail(int exit_code, const std::string& reason, Micros now);

  SimulatorConfig config_;
  SimulateStep simulate_;
  Publish publish_;

  Phase phase_ = Phase::Gathering;
  int64_t published_ = kBeforeStart;  ///< last ROBOT_STATE
  int64_t last_step_;                 ///< E: N, or less after a stop
  int64_t input_seq_ = 0, input_step_ = 0;
  std::vector<Action> actions_;  ///< of the INPUTs for the next step
  std::optional<Micros> neighbour_heard_;
  bool paused_ = false;
  bool restart_requested_ = false;
  int64_t single_steps_ = 0;  ///< steps that a paused run may still take
  std::string mode_ = "RUNNING";
  IdleTimer idle_timer_;
  Bytes end_;  ///< the encoded END message

 private:
  struct Peer {
    std::string state;
    int32_t pid = 0;
    int64_t heard = INT64_MIN;  ///< newest utime
    std::set<int32_t> former;   ///< pids that this name had before, at most kMaxFormer
    int64_t step = -1;
    bool ready = false;
  };
  void announce();
  void introduce(Micros now);
  void on_process(const process_t& process, Micros now);
  void on_request(const request_t& request, Micros now);
  std::string why_not_now(const request_t& request, Micros now) const;
  std::string execute(const request_t& request, Micros now);
  std::string why_not(const Action& action);
  std::string in_force() const;
  void accept_input(const request_t& request, const Action& action);
  void start_if_ready(Micros now);
  void finish_if_logs_closed();
  std::string missing_processes() const;
  std::string open_log() const;

  bool announced_ = false;
  size_t introduced_ = 0;  ///< which message introduce() repeats next: 0 = RUN, then the types
  std::optional<Micros> next_introduction_;
  Micros run_sent_ = INT64_MIN / 2;  ///< the last time that it was asked for
  std::map<std::string, Peer> peers_;
  std::set<std::string> closed_;  ///< listeners whose log is closed
  ReplyCache replies_;
  Outcome outcome_, verdict_;
  Micros next_end_ = 0, started_at_ = 0, ended_at_ = 0;
};

}  // namespace lab
