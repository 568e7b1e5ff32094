// Messages as an earlier version of the lab wrote them, read by the TYPE messages of their own log.
#pragma once
#include <cstdint>
#include <lab/type_t.hpp>
#include <memory>
#include <span>
#include <vector>

#include "wire/schema/channels.h"
#include "wire/schema/schema.h"

namespace lab {

/// A later version of a message only ever has more fields, scalars or strings, at its end.
class EarlierTypes {
 public:
  /// A TYPE of the log.
  void add(const type_t& type);
  /// The message with the fields of this version, those that it lacks zero or empty; made in `converted` unless it is
  /// of this version. As it is if the log does not explain it: then the guard refuses it.
  std::span<const uint8_t> as_now(Channel channel, std::span<const uint8_t> bytes,
                                  std::vector<uint8_t>& converted);

 private:
  const Type* find(int64_t fingerprint);

  std::vector<Source> sources_;
  std::unique_ptr<Schema> schema_;  ///< of sources_; null until it is needed
};

}  // namespace lab
