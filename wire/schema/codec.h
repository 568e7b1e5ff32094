// Generated messages to bytes and back. lcm-gen's encoders read past the heap when a vector is shorter than its count,
// so lengths are compared with counts first, by code that the build generates from the .lcm files. lcm-gen's decoders
// trust counts, so decode only what a Guard accepted.
#pragma once
#include <cstdint>
#include <lab/count_fault.hpp>  // count_fault(message): empty, or which array differs in length from its count
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/util/big_endian.h"

namespace lab {

/// Encodes into `out` (resized; reuse it to save the allocation). Throws std::invalid_argument when a vector's length
/// is not its count.
template <class T>
void encode(const T& message, std::vector<uint8_t>& out) {
  if (std::string fault = count_fault(message); !fault.empty())
    throw std::invalid_argument("encode " + fault);
  out.resize(message.getEncodedSize());
  if (message.encode(out.data(), 0, static_cast<int>(out.size())) != static_cast<int>(out.size())) {
    throw std::invalid_argument(std::string("encode ") + T::getTypeName() + ": lcm-gen's encoder refused it");
  }
}

template <class T>
std::vector<uint8_t> encode(const T& message) {
  std::vector<uint8_t> out;
  encode(message, out);
  return out;
}

/// True if the bytes begin with the fingerprint of this build's T: messages of other versions have another one.
template <class T>
bool is_of_type(std::span<const uint8_t> bytes) {
  return bytes.size() >= 8 && load_big_endian<int64_t>(bytes.data()) == T::getHash();
}

/// Decodes bytes that a Guard accepted. Throws std::invalid_argument when they are of another type or truncated.
template <class T>
void decode(std::span<const uint8_t> bytes, T& out) {
  if (out.decode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) {
    throw std::invalid_argument(std::string("decode ") + T::getTypeName() + ": these " +
                                std::to_string(bytes.size()) + " bytes are not a valid one");
  }
}

template <class T>
T decode(std::span<const uint8_t> bytes) {
  T out;
  decode(bytes, out);
  return out;
}

}  // namespace lab
