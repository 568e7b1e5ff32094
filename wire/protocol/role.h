// The interface of a role: one participant of a run. A role is a state machine: it is handed accepted messages and the
// time, and publishes through a function. It owns no socket, file or clock, so that the same object runs as a process,
// in lab-solo and on the lossy bus of the unit tests. Rules: docs/architecture.md, "Lockstep".
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/util/exit_code.h"
#include "wire/protocol/timers.h"
#include "wire/schema/channels.h"

namespace lab {

using Bytes = std::vector<uint8_t>;
using Publish = std::function<void(Channel, std::span<const uint8_t>)>;

inline constexpr int64_t kWindow = 256;  ///< W: steps that a listener may be behind
inline constexpr Micros kNoSpin = -1;    ///< Bus::poll: sleep at once
/// Process names in the protocol; a controller of your own uses the same name.
inline constexpr const char* kSimulator = "simulator";
inline constexpr const char* kPlanner = "planner";
inline constexpr const char* kController = "controller";
inline constexpr const char* kLogger = "logger";
inline constexpr const char* kRenderer = "renderer";

inline constexpr int64_t kBeforeStart = -1;  ///< the `step` of RUN, and of NEED that asks for it

/// Whether and how a role has ended.
struct Outcome {
  bool ended = false;
  int exit_code = kOk;
  std::string reason;  ///< one line; empty when all is well
};

/// Why the guard refused a message, with as much of its header as could be read.
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
  /// Takes note of a message that the guard refused.
  virtual void refused(const Refusal&, Micros) {}
  /// Takes note of a message that was dropped because its sender may not publish it.
  virtual void stranger(Channel, const std::string& /*reason*/, Micros) {}
  /// Takes note that another lab's simulator is on the bus, with the same channels.
  virtual void neighbour(Micros) {}
  /// Does what is due. Call it after the waiting messages were received, at wake(), and at least every kRepeat.
  virtual void tick(Micros now) = 0;
  virtual Micros wake() const = 0;
  /// us for which received messages may wait (batch_us of Bus::poll), so that one wake-up handles many.
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
  virtual int64_t late() const { return late_; }

 protected:
  int64_t late_ = 0;  ///< messages for steps already closed
};

}  // namespace lab
