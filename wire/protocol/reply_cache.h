// The last request of each sender with the reply to it, bounded: a request is executed once, however often it arrives.
#pragma once
#include <cstdint>
#include <map>
#include <string>

#include "wire/protocol/role.h"

namespace lab {

class ReplyCache {
 public:
  static constexpr size_t kMaxSenders = 4096;
  static constexpr Micros kForget = 10'000'000;  ///< us; a sender that was silent for so long is forgotten

  struct Answer {
    const Bytes* reply = nullptr;  ///< not null: this request was executed before
    std::string refusal;           ///< not empty: it must not be executed
  };
  /// `urgent` (estop): never refused; the sender that was silent for longest makes room.
  Answer look_up(const std::string& sender, int64_t id, bool urgent, Micros now);
  /// Keeps the reply to a request that look_up() has let through.
  void remember(const std::string& sender, int64_t id, Bytes reply, Micros now);
  size_t size() const { return entries_.size(); }

 private:
  struct Entry {
    int64_t id = 0;
    Bytes reply;
    Micros heard = 0;
  };
  void forget_silent(Micros now);

  std::map<std::string, Entry> entries_;  ///< by sender
  Micros next_look_ = 0;
};

}  // namespace lab
