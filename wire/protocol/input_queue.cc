#include "wire/protocol/input_queue.h"

#include <algorithm>
#include <lab/input_t.hpp>

#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab {

void InputQueue::add(std::span<const uint8_t> input) {
  const int64_t seq = decode<input_t>(input).input_seq;
  if (seq > applied_ && waiting_.size() < kMaxWaiting) waiting_.try_emplace(seq, input.begin(), input.end());
}

bool InputQueue::complete_to(int64_t seq) const {
  for (int64_t i = applied_ + 1; i <= seq; ++i)
    if (!waiting_.contains(i)) return false;
  return true;
}

std::vector<Action> InputQueue::take_to(int64_t seq) {
  std::vector<Action> actions;
  while (!waiting_.empty() && waiting_.begin()->first <= seq) {
    actions.push_back(to_signal(decode<input_t>(waiting_.begin()->second).action));
    waiting_.erase(waiting_.begin());
  }
  applied_ = std::max(applied_, seq);
  return actions;
}

}  // namespace lab
