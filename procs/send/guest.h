// The bus of a lab for a program that is no part of its run: request and answer, with a guard.
#pragma once
#include <signal.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <utility>

#include "wire/bus/bus.h"
#include "wire/process/launch_record.h"
#include "wire/protocol/role.h"
#include "wire/schema/guard.h"

namespace lab::send {

/// The signal that ended all waiting; 0 = none.
extern volatile sig_atomic_t interrupted;

struct Options {
  std::string url, prefix;
  std::string run;      ///< hexadecimal; empty = the one that answers
  std::string run_dir;  ///< the lab's folder, whose record tells its simulator from others; empty = not known
  double timeout = 5;   ///< s, of all waiting together
  double wait_seconds = 0;  ///< s to wait at most until a goal is reached; 0 = as long as it takes
  bool as_json = false;
  bool follow = false;  ///< receives what the run publishes, too
};

class Guest {
 public:
  explicit Guest(const Options& options);

  /// 0 while not bound to a run.
  int64_t run() const { return run_; }

  /// Binds to the lab's run: a request must not reach another lab, nor, when a reply is lost, the next run. Returns false
  /// without an answer. Throws UsageError when several labs answer.
  bool bind_to_run();

  using Take = std::function<bool(Channel, std::span<const uint8_t>)>;
  /// Sends `message` every 100 ms until `take` accepts a received message; false on timeout, and after `longest` us.
  bool ask(Channel channel, const Bytes& message, const Take& take, Micros longest = kForever);

  /// Receives until `take` accepts a message; false when nothing has come for `silence` us, or at the time `until`.
  bool listen(const Take& take, Micros silence, Micros until);

  /// A NEED that the simulator answers with RUN and what has happened so far.
  Bytes ask_for_run() const;

 private:
  static constexpr Micros kForever = 1'000'000'000'000;
  static constexpr Micros kOthersAnswerIn = 30'000;

  /// Polls once. Returns true if a message of the lab came.
  bool poll(Micros span, const Take& take, bool& accepted);
  bool is_of_the_lab(Channel channel, uint64_t sender);
  void bind(int64_t run) { guard_.set_run(run_ = run); }

  const Options& options_;
  Guard guard_;
  Micros until_;
  int64_t run_ = 0;
  LaunchRecord record_;
  std::set<uint64_t> simulators_, planners_;  ///< their addresses
  std::unique_ptr<Bus> bus_;
};

}  // namespace lab::send
