#pragma once
#include <lab/command_t.hpp>
#include <lab/process_t.hpp>
#include <lab/request_t.hpp>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "procs/signals/signals.h"
#include "procs/wire/role.h"
#include "procs/wire/step_record.h"

namespace lab {

struct SequencerConfig {
  Bytes run;  ///< the encoded RUN message
  int64_t run_id = 0, model_hash = 0, nonce = 0;
  int nq = 0, nv = 0;
  double dt = 0;          ///< s
  int64_t last_step = 0;  ///< N
  int64_t every = 1;      ///< a COMMAND is due at every step that this divides
  int64_t lead = 0;       ///< steps that the planner may be ahead
  std::vector<std::string> required = {kPlanner, kController, kLogger};  ///< must be READY before step 0
  std::vector<std::string> listeners = {kLogger};                        ///< whose ACK gives credit
  Micros deadline = 10'000'000, ready_deadline = 10'000'000;
};

/// What one step of the simulator gives.
struct Advance {
  RobotState state;
  std::vector<Event> events;
  std::string abort;  ///< not empty: the state cannot be published, the run ends with a safety stop
};
/// Makes the state of `step` from the one before. `command` is null when none is new; actions hold from this step on.
using AdvanceStep = std::function<Advance(int64_t step, const Command* command, std::span<const Action> actions)>;

/// The simulator's side of lockstep: the only one that decides which step comes next, and the only one that repairs
/// what others missed. Publishes ROBOT_STATE k+1 once REFERENCE k and, when due, COMMAND k are here.
class Sequencer : public Role {
 public:
  Sequencer(SequencerConfig config, AdvanceStep advance, Publish publish);

  void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) override;
  void refused(const Refusal& refusal, Micros now) override;
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
  /// From the first ROBOT_STATE to END.
  Micros running_time() const { return ended_at_ - started_at_; }

 private:
  enum class Phase { Gathering, Running, Ending, Over };
  struct Peer {
    std::string state;
    int32_t pid = 0;
    int64_t heard = INT64_MIN;  ///< newest utime
    std::set<int32_t> former;   ///< pids that this name had before
    int64_t step = -1;
    bool ready = false;
  };

  void on_process(const process_t& process, Micros now);
  void on_request(const request_t& request, Micros now);
  void on_need(int64_t step, Micros now);
  void file(Channel channel, std::span<const uint8_t> bytes);

  void start_if_ready(Micros now);
  void advance_while_possible(Micros now);
  bool answered(int64_t step);
  bool credit_for(int64_t step) const;
  bool publish_state(int64_t step, Micros now);
  void end(bool aborted, const std::string& reason, Micros now);
  void fail(int exit_code, const std::string& reason, Micros now);
  void leave_if_all_closed();
  void ask_for_answers();
  std::string silent_party();
  std::string missing_party() const;

  bool command_due(int64_t step) const { return step % config_.every == 0; }
  int64_t utime(int64_t step) const;
  void resend(const StepRecord& record);

  SequencerConfig config_;
  AdvanceStep advance_;
  Publish publish_;

  Phase phase_ = Phase::Gathering;
  int64_t published_ = kBeforeStart;  ///< last ROBOT_STATE
  int64_t last_step_;                 ///< E: N, or less after a stop
  bool paused_ = false;
  int64_t single_steps_ = 0;  ///< steps that a paused run may still take
  int64_t input_seq_ = 0, input_step_ = 0;
  std::vector<Action> actions_;  ///< of the INPUTs for the next step

  StepRing ring_{2 * kWindow};
  std::map<std::string, Peer> peers_;
  std::map<std::string, int64_t> acks_;
  std::set<std::string> closed_;  ///< listeners whose log is closed
  std::map<std::pair<std::string, int64_t>, Bytes> replies_;

  Bytes end_;  ///< the encoded END message
  Outcome outcome_, verdict_;
  std::string last_refusal_;

  Patience patience_;
  int asked_ = 0;
  std::map<int64_t, Micros> resent_;  ///< when a step was last sent again
  Silence silence_;
  Micros next_end_ = 0, started_at_ = 0, ended_at_ = 0;
  command_t command_;  ///< kept for its memory
};

}  // namespace lab
