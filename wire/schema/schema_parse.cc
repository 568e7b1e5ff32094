#include "wire/schema/schema_parse.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <cfloat>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <set>

namespace lab {
namespace {

constexpr size_t kMaxCounts = 32;  // members of one struct that count others
constexpr size_t kShown = 60;      // bytes of a word in an error

constexpr std::array<std::string_view, 9> kPrimitives = {"int8_t", "int16_t", "int32_t", "int64_t", "byte",
                                                         "float",  "double",  "string",  "boolean"};

std::optional<Kind> primitive(std::string_view name) {
  for (size_t i = 0; i < kPrimitives.size(); ++i) {
    if (kPrimitives[i] == name) return static_cast<Kind>(i);
  }
  return std::nullopt;
}

bool is_count(Kind kind) { return kind <= Kind::Int64; }

bool is_word(std::string_view s, bool dots) {
  if (s.empty() || !(std::isalpha(static_cast<unsigned char>(s[0])) || s[0] == '_')) return false;
  for (char c : s) {
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && !(dots && c == '.')) return false;
  }
  return s.back() != '.' && s.find("..") == std::string_view::npos;
}

// strtoll with base 0 over the whole text, as lcm-gen reads sizes and constants (so 010 is eight).
std::optional<int64_t> integer(const std::string& text) {
  char* end = nullptr;
  errno = 0;
  const long long v = std::strtoll(text.c_str(), &end, 0);
  if (text.empty() || end != text.c_str() + text.size() || errno == ERANGE) return std::nullopt;
  return v;
}

struct Token {
  std::string_view text;
  int line = 0;
};

class Parser {
 public:
  explicit Parser(const Source& source) : file_(source.file), rest_(source.text) { advance(); }

  Declarations run() {
    while (!token_.text.empty()) {
      if (take("package")) {
        package_ = word("a package name", true);
        require(";");
      } else if (take("struct")) {
        parse_struct();
      } else if (take("enum")) {
        parse_enum();
      } else {
        fail("expected package, struct or enum, found " + found());
      }
    }
    return std::move(out_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw SchemaError(file_ + ":" + std::to_string(token_.line) + ": " + what);
  }

  /// What is there, for an error.
  std::string found() const {
    if (token_.text.empty()) return "the end of the text";
    const bool is_long = token_.text.size() > kShown;
    return "'" + std::string(token_.text.substr(0, kShown)) + (is_long ? "..'" : "'");
  }

  void skip_blanks() {
    const auto drop = [&](size_t n) {
      for (char c : rest_.substr(0, n)) line_ += c == '\n';
      rest_.remove_prefix(std::min(n, rest_.size()));
    };
    while (!rest_.empty()) {
      if (std::isspace(static_cast<unsigned char>(rest_[0]))) {
        drop(1);
      } else if (rest_.starts_with("//")) {
        drop(std::min(rest_.find('\n'), rest_.size()));
      } else if (rest_.starts_with("/*")) {
        const size_t end = rest_.find("*/", 2);
        if (end == std::string_view::npos) {
          token_.line = line_;
          fail("a comment that starts here never ends");
        }
        drop(end + 2);
      } else {
        return;
      }
    }
  }

  // Tokens as in lcm-gen: names and numbers run on until a blank, a bracket, a comma or an operator. Braces
  // need no blank around them here (lcm-gen wants one before).
  void advance() {
    skip_blanks();
    token_.line = line_;
    constexpr std::string_view kSingle = "();\",:'[]{}!~<>=&|^%*+/";
    size_t n = 0;
    while (n < rest_.size() && !std::isspace(static_cast<unsigned char>(rest_[n])) &&
           kSingle.find(rest_[n]) == std::string_view::npos) {
      ++n;
    }
    if (n == 0 && !rest_.empty()) n = 1;
    token_.text = rest_.substr(0, n);
    rest_.remove_prefix(n);
  }

  bool take(std::string_view text) {
    if (token_.text != text) return false;
    advance();
    return true;
  }

  void require(std::string_view text) {
    if (take(text)) return;
    fail("expected '" + std::string(text) + "', found " + found());
  }

  std::string word(const char* what, bool dots = false) {
    if (!is_word(token_.text, dots)) fail(std::string("expected ") + what + ", found " + found());
    std::string s(token_.text);
    advance();
    return s;
  }

  std::string any(const char* what) {
    if (token_.text.empty()) fail(std::string("the text ends where ") + what + " should be");
    std::string s(token_.text);
    advance();
    return s;
  }

  std::string full_name(const std::string& name) const {
    return name.find('.') != std::string::npos || package_.empty() ? name : package_ + "." + name;
  }

  void parse_struct() {
    Type type;
    out_.type_lines.push_back(token_.line);
    type.name = full_name(word("a struct name", true));
    out_.field_lines.emplace_back();
    require("{");
    while (!take("}")) {
      if (token_.text == "struct" || token_.text == "enum") {
        fail("a " + std::string(token_.text) + " cannot be declared inside a struct");
      }
      if (take("const")) {
        parse_constants(type);
      } else {
        parse_members(type);
      }
    }
    std::set<int> counts;
    for (const Field& f : type.fields)
      for (const Dim& d : f.dims)
        if (d.member >= 0) counts.insert(d.member);
    if (counts.size() > kMaxCounts)
      fail(type.name + " has " + std::to_string(counts.size()) + " members that are array sizes, at most " +
           std::to_string(kMaxCounts) + " are supported");
    out_.types.push_back(std::move(type));
  }

  void check_free(const Type& type, const std::string& name) const {
    for (const Field& f : type.fields) {
      if (f.name == name) fail("two members named '" + name + "'");
    }
    for (const Constant& c : type.constants) {
      if (c.name == name) fail("two members named '" + name + "'");
    }
  }

  void parse_members(Type& type) {
    Field base;
    const std::string type_name = word("a type", true);
    if (const auto kind = primitive(type_name)) {
      base.kind = *kind;
      base.type_name = type_name;
    } else {
      base.kind = Kind::Struct;  // or an enum: settled when all texts are known
      base.type_name = full_name(type_name);
    }
    do {
      Field field = base;
      out_.field_lines.back().push_back(token_.line);
      field.name = word("a member name");
      check_free(type, field.name);
      while (take("[")) field.dims.push_back(parse_dim(type));
      type.fields.push_back(std::move(field));
    } while (take(","));
    require(";");
  }

  Dim parse_dim(const Type& type) {
    Dim dim;
    dim.text = any("an array size");
    const auto constant = std::find_if(type.constants.begin(), type.constants.end(),
                                       [&](const Constant& c) { return c.name == dim.text; });
    if (constant != type.constants.end()) dim.text = constant->value;  // since LCM 1.5
    if (constant != type.constants.end() || std::isdigit(static_cast<unsigned char>(dim.text[0]))) {
      const auto n = integer(dim.text);
      if (!n || *n <= 0 || *n > INT32_MAX)
        fail("array size '" + dim.text + "' must be a whole number from 1 to 2147483647");
      dim.size = *n;
    } else {
      for (size_t i = 0; i < type.fields.size(); ++i) {
        if (type.fields[i].name == dim.text) dim.member = static_cast<int>(i);
      }
      if (dim.member < 0)
        fail("array size '" + dim.text + "' is neither a number nor a member or constant declared before");
      const Field& count = type.fields[dim.member];
      if (!count.dims.empty() || !is_count(count.kind))
        fail("array size '" + dim.text + "' must be a single integer member");
    }
    require("]");
    return dim;
  }

  void parse_constants(Type& type) {
    const std::string type_name = word("a type");
    const auto kind = primitive(type_name);
    if (!kind || *kind > Kind::Double || *kind == Kind::Byte)
      fail("'" + type_name + "' cannot be the type of a constant");
    do {
      Constant c;
      c.type = type_name;
      c.name = word("a constant's name");
      check_free(type, c.name);
      require("=");
      c.value = any("a constant's value");
      check_value(*kind, c.value);
      type.constants.push_back(std::move(c));
    } while (take(","));
    require(";");
  }

  void check_value(Kind kind, const std::string& text) const {
    if (kind <= Kind::Int64) {
      const auto v = integer(text);
      const int bits = 8 << static_cast<int>(kind);
      const bool fits =
          v && (bits == 64 || (*v >= -(int64_t{1} << (bits - 1)) && *v < int64_t{1} << (bits - 1)));
      if (!fits) fail("'" + text + "' is not an " + std::string(kind_name(kind)));
    } else {
      char* end = nullptr;
      const double v = std::strtod(text.c_str(), &end);
      if (end != text.c_str() + text.size() || (kind == Kind::Float && std::abs(v) > FLT_MAX)) {
        fail("'" + text + "' is not a " + std::string(kind_name(kind)));
      }
    }
  }

  void parse_enum() {
    EnumType type;
    out_.enum_lines.push_back(token_.line);
    const std::string name = word("an enum name", true);
    type.name = full_name(name);
    type.fingerprint = enum_hash(std::string_view(name).substr(name.rfind('.') + 1));
    require("{");
    while (!take("}")) {
      const std::string value_name = word("an enum value's name");
      int64_t value = 1;
      if (take("=")) {
        const std::string text = any("an enum value");
        const auto v = integer(text);
        if (!v) fail("'" + text + "' is not a whole number");
        value = *v;
      } else {
        for (const auto& [other, v] : type.values) value = std::max(value, int64_t{v} + 1);
      }
      if (value < INT32_MIN || value > INT32_MAX)
        fail("enum value " + std::to_string(value) + " is not an int32_t");
      for (const auto& [other, v] : type.values) {
        if (other == value_name || v == value)
          fail("enum values '" + other + "' and '" + value_name + "' are the same");
      }
      type.values.emplace_back(value_name, static_cast<int32_t>(value));
      take(",");
      take(";");
    }
    out_.enums.push_back(std::move(type));
  }

  std::string file_;
  std::string_view rest_;
  int line_ = 1;
  Token token_;
  std::string package_;
  Declarations out_;
};

// lcm-gen's rolling hash: signed, with an arithmetic shift, over signed characters.
int64_t mix(int64_t v, int8_t c) {
  const uint64_t shifted = (static_cast<uint64_t>(v) << 8) ^ static_cast<uint64_t>(v >> 55);
  return static_cast<int64_t>(shifted + static_cast<uint64_t>(static_cast<int64_t>(c)));
}

int64_t mix(int64_t v, std::string_view s) {
  v = mix(v, static_cast<int8_t>(s.size()));
  for (char c : s) v = mix(v, static_cast<int8_t>(c));
  return v;
}

}  // namespace

std::string_view kind_name(Kind kind) {
  return kind <= Kind::Boolean ? kPrimitives[static_cast<size_t>(kind)]
         : kind == Kind::Enum  ? "enum"
                               : "struct";
}

int64_t own_hash(const Type& type) {
  int64_t v = 0x12345678;
  for (const Field& f : type.fields) {
    v = mix(v, f.name);
    if (f.kind <= Kind::Boolean) v = mix(v, f.type_name);
    v = mix(v, static_cast<int8_t>(f.dims.size()));
    for (const Dim& d : f.dims) {
      v = mix(v, static_cast<int8_t>(d.member >= 0));
      v = mix(v, d.text);
    }
  }
  return v;
}

int64_t enum_hash(std::string_view short_name) { return mix(int64_t{0x87654321}, short_name); }

Declarations parse_lcm(const Source& source) { return Parser(source).run(); }

}  // namespace lab
