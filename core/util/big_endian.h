// Integers as LCM messages, logs and datagrams hold them: most significant byte first, at any address.
#pragma once
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>
#include <vector>

namespace lab {

namespace detail {

template <std::unsigned_integral T>
constexpr T to_big_endian(T x) {
  if constexpr (std::endian::native == std::endian::big || sizeof(T) == 1) return x;
  if constexpr (sizeof(T) == 2) return __builtin_bswap16(x);
  if constexpr (sizeof(T) == 4) return __builtin_bswap32(x);
  if constexpr (sizeof(T) == 8) return __builtin_bswap64(x);
}

}  // namespace detail

/// The integer in the sizeof(Integer) bytes at p.
template <std::integral Integer>
Integer load_big_endian(const uint8_t* p) {
  std::make_unsigned_t<Integer> x;
  std::memcpy(&x, p, sizeof x);
  return static_cast<Integer>(detail::to_big_endian(x));
}

/// Writes sizeof(Integer) bytes at p.
template <std::integral Integer>
void store_big_endian(uint8_t* p, Integer value) {
  const auto x = detail::to_big_endian(static_cast<std::make_unsigned_t<Integer>>(value));
  std::memcpy(p, &x, sizeof x);
}

/// Appends sizeof(Integer) bytes.
template <std::integral Integer>
void append_big_endian(std::vector<uint8_t>& out, Integer value) {
  out.resize(out.size() + sizeof value);
  store_big_endian(out.data() + out.size() - sizeof value, value);
}

}  // namespace lab
