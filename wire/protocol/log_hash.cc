#include "wire/protocol/log_hash.h"

#include <xxhash.h>

namespace lab {

LogHash::LogHash() : state_(XXH3_createState(), [](XXH3_state_s* state) { XXH3_freeState(state); }) {
  reset();
}

void LogHash::reset() { XXH3_64bits_reset(state_.get()); }

void LogHash::add(std::span<const uint8_t> bytes) {
  XXH3_64bits_update(state_.get(), bytes.data(), bytes.size());
}

void LogHash::add(Channel channel, std::span<const uint8_t> message) {
  const uint64_t head[2] = {static_cast<uint64_t>(channel), message.size()};
  XXH3_64bits_update(state_.get(), head, sizeof head);
  add(message);
}

int64_t LogHash::value() const {
  const auto value = static_cast<int64_t>(XXH3_64bits_digest(state_.get()));
  return value ? value : 1;
}

}  // namespace lab
