#include "wire/schema/schema.h"

#include <algorithm>
#include <limits>

#include "wire/schema/schema_parse.h"
#include "wire/schema/schema_texts.h"

namespace lab {
namespace {

constexpr int kMaxHashSteps = 1'000'000;  // bounds the time for types that nest each other

uint8_t width_of(Kind kind) {
  switch (kind) {
    case Kind::Int8:
    case Kind::Byte:
    case Kind::Boolean:
      return 1;
    case Kind::Int16:
      return 2;
    case Kind::Int32:
    case Kind::Float:
    case Kind::Enum:
      return 4;
    case Kind::Int64:
    case Kind::Double:
      return 8;
    default:
      return 0;  // no fixed size
  }
}

// Product, saturated at a number that no message can hold.
uint64_t times(uint64_t a, uint64_t b) {
  constexpr uint64_t kTooMany = uint64_t{1} << 60;
  return b != 0 && a > kTooMany / b ? kTooMany : a * b;
}

bool is_fixed(const Field& f) {
  return std::all_of(f.dims.begin(), f.dims.end(), [](const Dim& d) { return d.member < 0; });
}

uint64_t fixed_count(const Field& f) {
  uint64_t n = 1;
  for (const Dim& d : f.dims) n = times(n, static_cast<uint64_t>(d.size));
  return n;
}

// Fingerprints as lcm-gen's generated code computes them: own hash plus those of the struct members, rotated
// left by one; a type met again below itself counts 0.
class Fingerprints {
 public:
  Fingerprints(const std::vector<Type>& types, const std::vector<EnumType>& enums)
      : types_(types), enums_(enums), done_(types.size()), active_(types.size()) {}

  int64_t of(int type) {
    bool cut = false;
    return static_cast<int64_t>(sum(type, cut));
  }

 private:
  struct Done {
    bool known = false;
    uint64_t hash = 0;
  };

  // `cut`: a type above ended the sum, so that it holds in this context only.
  uint64_t sum(int type, bool& cut) {
    if (active_[type]) {
      cut = true;
      return 0;
    }
    if (done_[type].known) return done_[type].hash;
    if (++steps_ > kMaxHashSteps)
      throw SchemaError(types_[type].name + ": types nest each other too often to hash");
    active_[type] = true;
    bool cut_here = false;
    uint64_t hash = static_cast<uint64_t>(own_hash(types_[type]));
    for (const Field& f : types_[type].fields) {
      if (f.kind == Kind::Struct) hash += sum(f.type, cut_here);
      if (f.kind == Kind::Enum) hash += static_cast<uint64_t>(enums_[f.type].fingerprint);
    }
    hash = hash << 1 | hash >> 63;
    active_[type] = false;
    if (!cut_here) done_[type] = {true, hash};
    cut |= cut_here;
    return hash;
  }

  const std::vector<Type>& types_;
  const std::vector<EnumType>& enums_;
  std::vector<Done> done_;
  std::vector<bool> active_;
  int steps_ = 0;
};

}  // namespace

Schema::Schema(std::vector<Source> sources)
    : Schema(std::move(sources), [](const std::string& why) { throw SchemaError(why); }) {}

Schema::Schema(std::vector<Source> sources, const std::function<void(const std::string&)>& fault) {
  for (ParsedSource& parsed : parse_together(std::move(sources), fault)) {
    for (EnumType& e : parsed.declared.enums) enums_.push_back(std::move(e));
    for (Type& t : parsed.declared.types) {
      t.source = static_cast<int>(sources_.size());
      t.index = static_cast<int>(types_.size());
      by_name_.emplace(t.name, t.index);
      types_.push_back(std::move(t));
    }
    sources_.push_back(std::move(parsed.source));
  }
  resolve_names();
  Fingerprints fingerprints(types_, enums_);
  for (Type& t : types_) t.fingerprint = fingerprints.of(t.index);
  compile();
}

// Every name is that of a struct or of an enum.
void Schema::resolve_names() {
  std::map<std::string, int, std::less<>> enum_names;
  for (size_t i = 0; i < enums_.size(); ++i) enum_names.emplace(enums_[i].name, static_cast<int>(i));
  for (Type& t : types_) {
    for (Field& f : t.fields) {
      if (f.kind != Kind::Struct) continue;
      const auto s = by_name_.find(f.type_name);
      if (s == by_name_.end()) f.kind = Kind::Enum;
      f.type = s != by_name_.end() ? s->second : enum_names.at(f.type_name);
    }
  }
}

// The operation for a member of that kind; `counts`: it is the size of an array.
Schema::Op::Code Schema::code_of(Kind kind, bool counts) {
  switch (kind) {
    case Kind::Boolean:
      return Op::Bool;
    case Kind::Float:
      return Op::Float;
    case Kind::Double:
      return Op::Double;
    case Kind::String:
      return Op::String;
    case Kind::Struct:
      return Op::Call;
    case Kind::Int8:
    case Kind::Int16:
    case Kind::Int32:
    case Kind::Int64:
    case Kind::Byte:
    case Kind::Enum:
      break;
  }
  return counts ? Op::Count : Op::Skip;
}

// Turns each type into a flat list of operations: what the walker runs.
void Schema::compile() {
  for (const Type& t : types_) {
    Program program;
    program.begin = static_cast<uint32_t>(ops_.size());
    std::vector<int> slot(t.fields.size(), -1);
    int slots = 0;
    for (const Field& f : t.fields) {
      for (const Dim& d : f.dims) {
        if (d.member >= 0 && slot[d.member] < 0) slot[d.member] = slots++;
      }
    }
    for (size_t i = 0; i < t.fields.size(); ++i) {
      const Field& f = t.fields[i];
      Op op;
      op.field = static_cast<int32_t>(i);
      op.width = width_of(f.kind);
      op.code = code_of(f.kind, slot[i] >= 0);
      op.type = f.type;
      if (slot[i] >= 0) op.slot = static_cast<uint8_t>(slot[i]);
      if (is_fixed(f)) {
        op.fixed = fixed_count(f);
      } else {
        op.dims = static_cast<uint32_t>(dims_.size());
        op.ndims = static_cast<uint32_t>(f.dims.size());
        for (const Dim& d : f.dims) dims_.push_back(d.member < 0 ? d.size : -1 - slot[d.member]);
      }
      // integers in a row are one skip
      if (op.code == Op::Skip && op.ndims == 0) {
        op.fixed = times(op.fixed, op.width);
        op.width = 1;
        if (ops_.size() > program.begin && ops_.back().code == Op::Skip && ops_.back().ndims == 0) {
          ops_.back().fixed = std::min(ops_.back().fixed + op.fixed, uint64_t{1} << 60);
          continue;
        }
      }
      ops_.push_back(op);
    }
    program.end = static_cast<uint32_t>(ops_.size());
    programs_.push_back(program);
  }
}

const Type* Schema::find(std::string_view name) const {
  const auto it = by_name_.find(name);
  return it == by_name_.end() ? nullptr : &types_[it->second];
}

const Type* Schema::find(int64_t fingerprint) const {
  const auto it =
      std::find_if(types_.begin(), types_.end(), [&](const Type& t) { return t.fingerprint == fingerprint; });
  return it == types_.end() ? nullptr : &*it;
}

std::vector<const Type*> Schema::all_of(int64_t fingerprint) const {
  std::vector<const Type*> found;
  for (const Type& t : types_)
    if (t.fingerprint == fingerprint) found.push_back(&t);
  return found;
}

int Schema::fixed_offset(const Type& type, std::string_view field) const {
  uint64_t offset = sizeof(int64_t);  // the fingerprint
  for (const Field& f : type.fields) {
    if (f.name == field && f.dims.empty() && width_of(f.kind) > 0) return static_cast<int>(offset);
    const uint64_t width = width_of(f.kind);
    if (width == 0 || !is_fixed(f)) return -1;
    offset = std::min(offset + times(width, fixed_count(f)), uint64_t{1} << 60);
    if (offset > std::numeric_limits<int>::max()) return -1;
  }
  return -1;
}

}  // namespace lab
