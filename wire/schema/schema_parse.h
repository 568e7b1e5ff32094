// The parser behind Schema: one text in, declarations out. Names of types are completed with the package but not yet
// resolved.
#pragma once
#include <string>
#include <vector>

#include "wire/schema/schema.h"

namespace lab {

struct Declarations {
  std::vector<Type> types;
  std::vector<EnumType> enums;
  // where they are, for errors found later
  std::vector<int> type_lines, enum_lines;
  std::vector<std::vector<int>> field_lines;  ///< per type, per field
};

/// Throws SchemaError "file:line: what".
Declarations parse_lcm(const Source& source);

/// lcm-gen's hash of the struct alone: names and types of members, dimensions; not its own name.
int64_t own_hash(const Type& type);
/// lcm-gen's hash of an enum: of its short name alone.
int64_t enum_hash(std::string_view short_name);

/// The lcm-gen name of a primitive kind, such as "int32_t".
std::string_view kind_name(Kind kind);

}  // namespace lab
