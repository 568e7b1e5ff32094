// The .lcm language at run time: parses type texts, knows lcm-gen's fingerprints, walks encoded messages (the guard before
// the generated decoders) and decodes them to trees (spy, log tools). Source: the language and the hash as lcm-gen 1.3.1
// has them.
#pragma once
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "wire/schema/value.h"

namespace lab {

/// What a member is made of.
enum class Kind : uint8_t { Int8, Int16, Int32, Int64, Byte, Float, Double, String, Boolean, Enum, Struct };

struct Dim {
  int64_t size = 0;  ///< elements; when member >= 0 not used
  int member = -1;   ///< index of the member that counts; -1 = fixed
  std::string text;  ///< as written (of a constant: its value): part of the fingerprint
};

struct Field {
  std::string name;
  Kind kind = Kind::Int32;
  std::string type_name;  ///< as resolved: int32_t, lab.action_t
  int type = -1;          ///< Struct: index into Schema::types(); Enum: index into enums
  std::vector<Dim> dims;  ///< outermost first; empty = scalar
};

struct Constant {
  std::string type, name, value;
};

struct Type {
  std::string name;  ///< with package: lab.robot_state_t
  std::vector<Field> fields;
  std::vector<Constant> constants;
  int64_t fingerprint = 0;  ///< the first eight bytes of a message
  int source = -1;          ///< index of the text that declared it
  int index = -1;           ///< in Schema::types()
};

struct EnumType {
  std::string name;
  std::vector<std::pair<std::string, int32_t>> values;
  int64_t fingerprint = 0;
};

/// One text to parse; `file` names it in errors.
struct Source {
  std::string file, text;
};

/// `file:line: what is wrong`
struct SchemaError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct CheckOptions {
  bool finite = true;  ///< refuse NaN and infinities
  bool text = true;    ///< refuse strings with a NUL inside, which lcm-gen's C and C++ encoders cut short
};

class Schema {
 public:
  /// Parses all texts and resolves all names; throws SchemaError.
  explicit Schema(std::vector<Source> sources);
  /// The same of those texts that can be used together; calls fault(`file:line: what is wrong`) for each other one.
  Schema(std::vector<Source> sources, const std::function<void(const std::string&)>& fault);

  const std::vector<Type>& types() const { return types_; }
  const std::vector<Source>& sources() const { return sources_; }
  const Type* find(std::string_view name) const;  ///< by full name; null if there is none
  const Type* find(int64_t fingerprint) const;  ///< the first of that fingerprint; two equal structs collide
  std::vector<const Type*> all_of(int64_t fingerprint) const;

  /// Why the bytes are not a message of that type, naming the field, the value seen and the bound; empty =
  /// they are. The generated decoder is safe for accepted bytes: every count, length and depth is
  /// bounded, strings end in NUL, booleans are 0 or 1, nothing is left over. No allocation unless it refuses.
  std::string check(const Type& type, std::span<const uint8_t> bytes, CheckOptions options = {}) const;

  /// The message as a tree. Throws std::invalid_argument with check's reason; checks with both options
  /// off, so that a spy can show NaN.
  Value decode(const Type& type, std::span<const uint8_t> bytes) const;

  /// Byte offset of a scalar member in the message, if everything before it has a fixed size; else, or without
  /// such a member, -1.
  int fixed_offset(const Type& type, std::string_view field) const;

 private:
  friend class Walker;
  // One step of the flat program that a type is compiled to: a sequence of equal elements.
  struct Op {
    enum Code : uint8_t { Skip, Bool, Float, Double, String, Count, Call } code;
    uint8_t width = 0;   // bytes an element; Count: of the integer
    uint8_t slot = 0;    // Count: where the number goes
    int32_t field = 0;   // first field it covers, for messages
    int32_t type = -1;   // Call
    uint64_t fixed = 1;  // elements, or Skip: bytes; with dims: not used
    uint32_t dims = 0;   // first of ndims entries in dims_
    uint32_t ndims = 0;  // 0 = fixed
  };
  struct Program {
    uint32_t begin = 0, end = 0;  // in ops_
  };
  void resolve_names();
  static Op::Code code_of(Kind kind, bool counts);
  void compile();

  std::vector<Source> sources_;
  std::vector<Type> types_;
  std::vector<EnumType> enums_;
  std::map<std::string, int, std::less<>> by_name_;
  std::vector<Op> ops_;
  std::vector<int64_t> dims_;  // >= 0 a fixed size, < 0 the slot -1 - dim
  std::vector<Program> programs_;
};

}  // namespace lab
