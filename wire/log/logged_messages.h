// The loop over a log's messages: every event of a channel of the lab, checked by a guard.
#pragma once
#include <span>
#include <string>
#include <utility>

#include "wire/log/log_reader.h"
#include "wire/schema/guard.h"

namespace lab {

struct IgnoreRefused {
  void operator()(const LogEvent&, const Verdict&) const {}
};

/// Calls visit(channel, bytes) for each message that the guard accepts, and refused(event, verdict) for each other
/// message of the lab's channels. `visit` may set the guard's run and sizes: they hold for the events that follow.
template <class Visit, class Refused = IgnoreRefused>
void for_each_message(const std::string& path, const Guard& guard, Visit&& visit, Refused&& refused = {}) {
  LogReader reader(path);
  for (LogEvent event; reader.next(event);) {
    const auto channel = channel_of(event.channel);
    if (!channel) continue;
    if (const Verdict verdict = guard.check(*channel, event.data); verdict)
      visit(*channel, event.data);
    else
      refused(event, verdict);
  }
}

/// The same with a guard that accepts every run.
template <class Visit>
void for_each_message(const std::string& path, Visit&& visit) {
  for_each_message(path, Guard(), std::forward<Visit>(visit));
}

}  // namespace lab
