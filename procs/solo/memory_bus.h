// A bus within one process: a queue between the roles of a run.
#pragma once
#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "wire/protocol/role.h"

namespace lab::solo {

/// Connects the roles of a run in one thread: each message goes to all other roles, in order and without loss.
class MemoryBus {
 public:
  /// The publish function for the role that is added next.
  Publish publish() {
    return [this, from = roles_.size()](Channel channel, std::span<const uint8_t> bytes) {
      waiting_.push_back({from, channel, {bytes.begin(), bytes.end()}});
    };
  }
  void add(Role& role) { roles_.push_back(&role); }

  bool idle() const { return waiting_.empty(); }

  /// Delivers queued messages and those published meanwhile, at most `limit` messages, or until `until` ends.
  void deliver(const Role& until, Micros now, int limit) {
    for (; limit > 0 && !waiting_.empty() && !until.outcome().ended; --limit) {
      const Message message = std::move(waiting_.front());
      waiting_.pop_front();
      for (size_t i = 0; i < roles_.size(); ++i)
        if (i != message.from) roles_[i]->receive(message.channel, message.bytes, now);
    }
  }

 private:
  struct Message {
    size_t from;
    Channel channel;
    Bytes bytes;
  };
  std::vector<Role*> roles_;
  std::deque<Message> waiting_;
};

}  // namespace lab::solo
