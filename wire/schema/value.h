// A message as a tree, decoded at run time: what spies and log tools show.
#pragma once
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace lab {

struct Member;

struct Value {
  using Array = std::vector<Value>;
  using Struct = std::vector<Member>;  ///< in the order of the .lcm file
  std::variant<bool, int64_t, float, double, std::string, Array, Struct> is;

  /// Part of the tree by a path such as `q[0]` or `action.values[2]`; null if there is none.
  const Value* at(std::string_view path) const;
  /// The number, integer, or truth value as double; NaN for anything else.
  double number() const;
};

struct Member {
  std::string name;
  Value value;
};

/// `name: value` lines; structs indented by two, arrays of numbers in one line. Numbers are the shortest
/// text that reads back to the same value.
std::string to_text(const Value& value);

/// The same as JSON; non-finite numbers become null. Strings may hold any bytes: write them with json_text().
nlohmann::ordered_json to_json(const Value& value);

}  // namespace lab
