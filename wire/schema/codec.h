#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "wire/schema/guard.h"

/// Generated messages to bytes and back. lcm-gen's encoders read past the heap when a vector is shorter than
/// its count, so counts are compared with lengths first, driven by the schema: nothing to keep up by hand.
/// lcm-gen's decoders trust counts, so decode only what a Guard accepted.
namespace lab {

/// Compares every variable array of a message with its counts; empty = equal, else which and how.
/// `T` is a generated class.
template <class T>
std::string count_fault(const T& message);

/// Encodes into `out` (resized; reuse it to save the allocation). Throws std::invalid_argument when a
/// vector's length is not its count.
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

/// Decodes bytes that a Guard accepted. Throws std::invalid_argument when they are of another type or cut.
template <class T>
void decode(std::span<const uint8_t> bytes, T& out) {
  if (out.decode(bytes.data(), 0, static_cast<int>(bytes.size())) != static_cast<int>(bytes.size())) {
    throw std::invalid_argument(std::string("decode ") + T::getTypeName() + ": these " +
                                std::to_string(bytes.size()) + " bytes are not one");
  }
}

template <class T>
T decode(std::span<const uint8_t> bytes) {
  T out;
  decode(bytes, out);
  return out;
}

// Below: how count_fault sees the members of a generated class. They are plain aggregates, so structured
// bindings reach them in the order of the .lcm file.
namespace fields {

struct Any {
  template <class U>
  operator U() const;
};

template <class T, size_t... I>
constexpr bool takes(std::index_sequence<I...>) {
  return requires { T{(static_cast<void>(I), Any{})...}; };
}

// How many members T has (none of the lab's types holds a fixed array, which would count by element).
template <class T, size_t N = 32>
constexpr size_t count() {
  if constexpr (N == 0 || takes<T>(std::make_index_sequence<N>{})) {
    return N;
  } else {
    return count<T, N - 1>();
  }
}

// clang-format off
template <class T>
auto tie(const T& m) {
  constexpr size_t n = count<T>();
  static_assert(n >= 1 && n <= 23, "add a case below");
  if constexpr (n == 1) { auto& [a] = m; return std::tie(a); }
  else if constexpr (n == 2) { auto& [a, b] = m; return std::tie(a, b); }
  else if constexpr (n == 3) { auto& [a, b, c] = m; return std::tie(a, b, c); }
  else if constexpr (n == 4) { auto& [a, b, c, d] = m; return std::tie(a, b, c, d); }
  else if constexpr (n == 5) { auto& [a, b, c, d, e] = m; return std::tie(a, b, c, d, e); }
  else if constexpr (n == 6) { auto& [a, b, c, d, e, f] = m; return std::tie(a, b, c, d, e, f); }
  else if constexpr (n == 7) { auto& [a, b, c, d, e, f, g] = m; return std::tie(a, b, c, d, e, f, g); }
  else if constexpr (n == 8) { auto& [a, b, c, d, e, f, g, h] = m; return std::tie(a, b, c, d, e, f, g, h); }
  else if constexpr (n == 9) { auto& [a, b, c, d, e, f, g, h, i] = m; return std::tie(a, b, c, d, e, f, g, h, i); }
  else if constexpr (n == 10) {
    auto& [a, b, c, d, e, f, g, h, i, j] = m; return std::tie(a, b, c, d, e, f, g, h, i, j);
  } else if constexpr (n == 11) {
    auto& [a, b, c, d, e, f, g, h, i, j, k] = m; return std::tie(a, b, c, d, e, f, g, h, i, j, k);
  } else if constexpr (n == 12) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l] = m; return std::tie(a, b, c, d, e, f, g, h, i, j, k, l);
  } else if constexpr (n == 13) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o] = m; return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o);
  } else if constexpr (n == 14) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p);
  } else if constexpr (n == 15) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q);
  } else if constexpr (n == 16) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r);
  } else if constexpr (n == 17) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s);
  } else if constexpr (n == 18) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t);
  } else if constexpr (n == 19) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u);
  } else if constexpr (n == 20) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v);
  } else if constexpr (n == 21) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v, w] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v, w);
  } else if constexpr (n == 22) {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v, w, x] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v, w, x);
  } else {
    auto& [a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v, w, x, y] = m;
    return std::tie(a, b, c, d, e, f, g, h, i, j, k, l, o, p, q, r, s, t, u, v, w, x, y);
  }
}

// clang-format on

template <class X>
concept Message = requires { X::getTypeName(); };
template <class X>
constexpr bool is_vector = false;
template <class X>
constexpr bool is_vector<std::vector<X>> = true;

/// The type of that short name among lcmtypes/; throws std::logic_error when it has not `members` members.
const Type& type_named(const char* short_name, size_t members);
std::string length_fault(const Type& type, const Field& field, size_t dim, size_t length, int64_t count);

template <class X>
std::string fault_in(const X& x, const Type& type, const Field& field, size_t dim, const int64_t* counts) {
  if constexpr (is_vector<X>) {
    const Dim& d = field.dims[dim];
    const int64_t wanted = d.member < 0 ? d.size : counts[d.member];
    if (wanted < 0 || x.size() != static_cast<size_t>(wanted))
      return length_fault(type, field, dim, x.size(), wanted);
    if constexpr (!std::is_arithmetic_v<typename X::value_type>) {
      for (const auto& y : x) {
        if (std::string fault = fault_in(y, type, field, dim + 1, counts); !fault.empty()) return fault;
      }
    }
  } else if constexpr (Message<X>) {
    return count_fault(x);
  }
  return {};
}

}  // namespace fields

template <class T>
std::string count_fault(const T& message) {
  constexpr size_t n = fields::count<T>();
  static const Type& type = fields::type_named(T::getTypeName(), n);
  std::array<int64_t, n> counts{};
  std::string fault;
  const auto members = fields::tie(message);
  [&]<size_t... I>(std::index_sequence<I...>) {
    const auto count = [&](size_t i, const auto& x) {
      if constexpr (std::is_integral_v<std::remove_cvref_t<decltype(x)>>) counts[i] = x;
    };
    (count(I, std::get<I>(members)), ...);
    // stops at the first fault
    static_cast<void>(
        ((fault = fields::fault_in(std::get<I>(members), type, type.fields[I], 0, counts.data())).empty() &&
         ...));
  }(std::make_index_sequence<n>{});
  return fault;
}

}  // namespace lab
