#include "wire/schema/earlier_types.h"

#include <algorithm>

#include "core/util/big_endian.h"
#include "wire/schema/guard.h"

namespace lab {
namespace {

/// Whether two fields are encoded alike. Structs inside messages must be of this version.
bool same(const Schema& a, const Field& x, const Schema& b, const Field& y) {
  const auto same_dim = [](const Dim& d, const Dim& e) { return d.text == e.text; };
  return x.name == y.name && x.kind == y.kind && x.kind != Kind::Enum &&
         std::equal(x.dims.begin(), x.dims.end(), y.dims.begin(), y.dims.end(), same_dim) &&
         (x.kind != Kind::Struct || a.types()[x.type].fingerprint == b.types()[y.type].fingerprint);
}

/// Appends a zero or an empty string; false if the field is of another kind.
bool append_default(const Field& field, std::vector<uint8_t>& out) {
  if (!field.dims.empty()) return false;
  switch (field.kind) {
    case Kind::Int8:
    case Kind::Byte:
    case Kind::Boolean:
      out.resize(out.size() + 1);
      return true;
    case Kind::Int16:
      out.resize(out.size() + 2);
      return true;
    case Kind::Int32:
    case Kind::Float:
      out.resize(out.size() + 4);
      return true;
    case Kind::Int64:
    case Kind::Double:
      out.resize(out.size() + 8);
      return true;
    case Kind::String:
      append_big_endian(out, uint32_t{1});
      out.push_back(0);
      return true;
    case Kind::Enum:
    case Kind::Struct:
      return false;
  }
  return false;
}

}  // namespace

void EarlierTypes::add(const type_t& type) {
  sources_.push_back({type.name, type.source});
  schema_.reset();
}

const Type* EarlierTypes::find(int64_t fingerprint) {
  if (!schema_) {
    try {
      schema_ = std::make_unique<Schema>(sources_);
    } catch (const SchemaError&) {  // explains nothing
      schema_ = std::make_unique<Schema>(std::vector<Source>());
    }
  }
  return schema_->find(fingerprint);
}

std::span<const uint8_t> EarlierTypes::as_now(Channel channel, std::span<const uint8_t> bytes,
                                              std::vector<uint8_t>& converted) {
  const Type& now = *lab_schema().find(row(channel).type);
  if (bytes.size() < 8) return bytes;
  const auto fingerprint = load_big_endian<int64_t>(bytes.data());
  if (fingerprint == now.fingerprint) return bytes;
  const Type* then = find(fingerprint);
  if (!then || then->name != now.name || then->fields.size() >= now.fields.size() ||
      !schema_->check(*then, bytes).empty())
    return bytes;
  for (size_t i = 0; i < then->fields.size(); ++i)
    if (!same(*schema_, then->fields[i], lab_schema(), now.fields[i])) return bytes;
  converted.clear();
  append_big_endian(converted, now.fingerprint);
  converted.insert(converted.end(), bytes.begin() + 8, bytes.end());
  for (size_t i = then->fields.size(); i < now.fields.size(); ++i)
    if (!append_default(now.fields[i], converted)) return bytes;
  return converted;
}

}  // namespace lab
