// Compares the arrays of a generated message with the members that count them: what the generated count_fault calls.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

namespace lab {

/// What the length of one dimension must be.
struct Length {
  const char* member;  ///< the member with the count; empty for a fixed size
  int64_t size;
};

/// `TYPE: MEMBER has 1 elements, nv is 2`.
std::string length_text(const char* type, const char* member, size_t length, const Length& wanted);

template <class X>
constexpr bool is_vector = false;
template <class X>
constexpr bool is_vector<std::vector<X>> = true;

/// Compares the arrays in `x` with `lengths`, outermost first, and nested messages with their own counts.
/// Empty = equal, else which and how.
template <class X>
std::string length_fault(const char* type, const char* member, const X& x, std::span<const Length> lengths) {
  if constexpr (is_vector<X>) {
    const Length& wanted = lengths.front();
    if (wanted.size < 0 || x.size() != static_cast<size_t>(wanted.size))
      return length_text(type, member, x.size(), wanted);
    if constexpr (!std::is_arithmetic_v<typename X::value_type>) {
      for (const auto& y : x)
        if (std::string fault = length_fault(type, member, y, lengths.subspan(1)); !fault.empty())
          return fault;
    }
  } else if constexpr (std::is_array_v<X>) {
    for (const auto& y : x)
      if (std::string fault = length_fault(type, member, y, lengths.subspan(1)); !fault.empty()) return fault;
  } else if constexpr (requires { X::getTypeName(); }) {
    return count_fault(x);
  }
  return {};
}

template <class X>
std::string length_fault(const char* type, const char* member, const X& x,
                         std::initializer_list<Length> lengths) {
  return length_fault(type, member, x, std::span<const Length>(lengths.begin(), lengths.size()));
}

}  // namespace lab
