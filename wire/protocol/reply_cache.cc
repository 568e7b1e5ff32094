#include "wire/protocol/reply_cache.h"

#include <fmt/format.h>

#include <algorithm>

namespace lab {

/// Looks at most ten times a second, however many requests come.
void ReplyCache::forget_silent(Micros now) {
  if (now < next_look_) return;
  next_look_ = now + kRepeat;
  std::erase_if(entries_, [now](const auto& entry) { return now - entry.second.heard > kForget; });
}

ReplyCache::Answer ReplyCache::look_up(const std::string& sender, int64_t id, bool urgent, Micros now) {
  forget_silent(now);
  const auto known = entries_.find(sender);
  if (known != entries_.end()) {
    Entry& entry = known->second;
    entry.heard = now;
    if (id == entry.id) return {&entry.reply, {}};
    if (id < entry.id && !urgent)
      return {nullptr, fmt::format("request {} is stale: {} came before it", id, entry.id)};
    return {};
  }
  if (entries_.size() < kMaxSenders) return {};
  if (!urgent) return {nullptr, fmt::format("busy with {} other senders: try again", kMaxSenders)};
  entries_.erase(std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
    return a.second.heard < b.second.heard;
  }));
  return {};
}

void ReplyCache::remember(const std::string& sender, int64_t id, Bytes reply, Micros now) {
  Entry& entry = entries_[sender];
  entry = {std::max(id, entry.reply.empty() ? id : entry.id), std::move(reply), now};
}

}  // namespace lab
