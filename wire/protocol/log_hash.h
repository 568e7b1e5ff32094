// The hash by which a log proves its own content: of steps (digests), of RUN and TYPE (END.check), of events (CHECK).
#pragma once
#include <cstdint>
#include <memory>
#include <span>

#include "wire/schema/channels.h"

struct XXH3_state_s;

namespace lab {

/// XXH3 over everything that is added. Never 0, which means "not known".
class LogHash {
 public:
  LogHash();
  void reset();
  void add(std::span<const uint8_t> bytes);
  /// A message with its channel and length.
  void add(Channel channel, std::span<const uint8_t> message);
  int64_t value() const;

 private:
  std::unique_ptr<XXH3_state_s, void (*)(XXH3_state_s*)> state_;
};

}  // namespace lab
