#pragma once
#include <algorithm>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/util/exit_code.h"
#include "wire/schema/channels.h"

/// What every participant of a lockstep run has in common. A role is a state machine: it is handed accepted
/// messages and the time, and publishes through a function; it owns no socket, file or clock, so that the same
/// object runs as a process, in lab-solo and under the lossy bus of the unit tests.
/// The rules are those of docs/architecture.md, "Lockstep".
namespace lab {

using Bytes = std::vector<uint8_t>;
using Micros = int64_t;  ///< us of some monotonic clock that the caller chooses
using Publish = std::function<void(Channel, std::span<const uint8_t>)>;

inline constexpr int64_t kWindow = 256;          ///< W: steps that a listener may be behind
inline constexpr Micros kFirstWait = 1'000;      ///< T: wait before the first NEED
inline constexpr Micros kLongestWait = 100'000;  ///< T doubles up to this
inline constexpr Micros kNoSpin = -1;            ///< Bus::poll: sleep at once
inline constexpr Micros kRepeat = 100'000;       ///< period of ACK, END and PROCESS
/// The names under which the four act in the protocol; a foreign controller takes the name too.
inline constexpr const char* kSimulator = "simulator";
inline constexpr const char* kPlanner = "planner";
inline constexpr const char* kController = "controller";
inline constexpr const char* kLogger = "logger";

inline constexpr int64_t kBeforeStart = -1;  ///< the `step` of RUN, and of NEED that asks for it

/// How a role ended, or that it has not.
struct Outcome {
  bool ended = false;
  int exit_code = kOk;
  std::string reason;  ///< one line; empty when all is well
};

/// Why the guard turned a message down, with as much of its header as could be read.
struct Refusal {
  Channel channel;
  int64_t step;
  bool non_finite;
  std::string reason;
};

class Lateness;

class Role {
 public:
  virtual ~Role() = default;
  /// Takes a message that the guard accepted, of this run or of run 0.
  virtual void receive(Channel channel, std::span<const uint8_t> bytes, Micros now) = 0;
  /// Learns of a message that the guard refused.
  virtual void refused(const Refusal&, Micros) {}
  /// Does what time asks for. Call it after the waiting messages were received, at wake() and every kRepeat at least.
  virtual void tick(Micros now) = 0;
  virtual Micros wake() const = 0;
  /// How late it may look at what has arrived, as Bus::poll takes it: a role in no hurry is woken once for many.
  virtual Micros batch() const { return 0; }
  /// Real time: 0 for ordinary scheduling, else a rank among the lab's processes, higher first.
  virtual int urgency() const { return 0; }
  virtual const Lateness* lateness() const { return nullptr; }  ///< of its ticks; null without any
  virtual int64_t overruns() const { return 0; }
  /// Ends gracefully at the next chance.
  virtual void stop(Micros now) = 0;

  virtual const Outcome& outcome() const = 0;
  virtual std::string state() const = 0;   ///< STARTING READY RUNNING HOLDING STOPPING FAULT, as in PROCESS
  virtual int64_t step() const = 0;        ///< last step finished; -1 = none
  virtual int64_t run() const = 0;         ///< 0 while unknown
  virtual int64_t model_hash() const = 0;  ///< 0 while unknown
  virtual int nq() const = 0;              ///< 0 while unknown
  virtual int nv() const = 0;
  int64_t late() const { return late_; }

 protected:
  int64_t late_ = 0;  ///< messages for steps already closed
};

/// When to ask again: T, doubling while nothing comes, back to T on progress.
class Patience {
 public:
  void reset(Micros now) { wait_ = kFirstWait, due_ = now + wait_; }
  void hurry(Micros now) { due_ = now; }
  Micros due() const { return due_; }
  bool expired(Micros now) {
    if (now < due_) return false;
    due_ = now + wait_;
    wait_ = std::min(2 * wait_, kLongestWait);
    return true;
  }

 private:
  Micros wait_ = kFirstWait, due_ = 0;
};

/// How long nothing has happened, as seen by a process that may itself have been stopped meanwhile:
/// of any gap between two looks only a little is counted.
class Silence {
 public:
  void progress() { total_ = 0; }
  void look(Micros now) {
    if (last_ >= 0) total_ += std::min(now - last_, 2 * kRepeat);
    last_ = now;
  }
  Micros total() const { return total_; }

 private:
  Micros total_ = 0, last_ = -1;
};

}  // namespace lab
