// The steps of a log on their way from the file to who reads it: held back until it is known whether they are whole.
#pragma once
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "wire/log/findings.h"
#include "wire/log/log_reader.h"
#include "wire/protocol/step_record.h"
#include "wire/schema/channels.h"

namespace lab {

using VisitLogged = std::function<void(Channel, std::span<const uint8_t>)>;

/// One subclass for each clock.
class LoggedSteps {
 public:
  LoggedSteps(const VisitLogged& visit, LogFindings& findings) : visit_(visit), findings_(findings) {}
  virtual ~LoggedSteps() = default;
  LoggedSteps(const LoggedSteps&) = delete;
  LoggedSteps& operator=(const LoggedSteps&) = delete;

  /// A message of a step; the guard has accepted it.
  virtual void take(Channel channel, std::span<const uint8_t> message, const LogEvent& event) = 0;
  /// The events since the last CHECK are as they were written, or not.
  virtual void checked(bool as_written) = 0;
  /// END: the last step and its digest (0 = that step never closed).
  virtual void end(int64_t step, int64_t digest, const LogEvent& event) = 0;
  /// No END: the file ends.
  virtual void cut() = 0;

 protected:
  const VisitLogged& visit_;
  LogFindings& findings_;
};

/// Lockstep: a step is visited, in the order of the log, when its messages are all there and no digest contradicts
/// them. The digest of step k is in the ROBOT_STATE of step k+1.
class LockstepLoggedSteps : public LoggedSteps {
 public:
  using LoggedSteps::LoggedSteps;
  void take(Channel channel, std::span<const uint8_t> message, const LogEvent& event) override;
  void checked(bool) override {}
  void end(int64_t step, int64_t digest, const LogEvent& event) override;
  void cut() override;

 private:
  struct Step {
    StepRecord record;
    uint64_t offset = 0, bytes = 0;
    std::vector<int64_t> times;  ///< of its events
  };
  void close();
  void prove(int64_t step, int64_t digest);
  void visit_proven();
  void drop(const Step& step, const std::string& what);

  std::optional<Step> open_;     ///< its messages are arriving
  std::optional<Step> waiting_;  ///< whole, until its digest is known
  int64_t last_ = -1;            ///< the last whole step
};

/// Real time: messages are visited in their order, when a CHECK has proven them. Those that no CHECK follows (a log that
/// was cut off, or of an earlier version) are visited if their steps can be.
class RealtimeLoggedSteps : public LoggedSteps {
 public:
  using LoggedSteps::LoggedSteps;
  void take(Channel channel, std::span<const uint8_t> message, const LogEvent& event) override;
  void checked(bool as_written) override;
  void end(int64_t step, int64_t digest, const LogEvent& event) override;
  void cut() override { visit_plausible(true); }

 private:
  struct Message {
    Channel channel;
    int64_t step;
    uint64_t offset, size;
    Bytes bytes;
  };
  void visit_plausible(bool at_end);
  std::vector<bool> plausible_states(bool at_end) const;

  std::vector<Message> held_;
  int64_t last_state_ = -1;
};

}  // namespace lab
