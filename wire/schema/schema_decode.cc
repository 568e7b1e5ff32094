#include <bit>

#include "core/util/big_endian.h"
#include "wire/schema/schema.h"

namespace lab {
namespace {

// Reads what check() has accepted, so nothing here can run out of bytes.
class Decoder {
 public:
  Decoder(const Schema& schema, const uint8_t* p) : s_(schema), p_(p) {}

  Value structure(const Type& type) {
    Value::Struct members;
    std::vector<int64_t> counts(type.fields.size());
    for (size_t i = 0; i < type.fields.size(); ++i) {
      const Field& f = type.fields[i];
      members.push_back({f.name, array(f, 0, counts)});
      if (const auto* n = std::get_if<int64_t>(&members.back().value.is)) counts[i] = *n;
    }
    return {std::move(members)};
  }

 private:
  Value array(const Field& f, size_t dim, const std::vector<int64_t>& counts) {
    if (dim == f.dims.size()) return element(f);
    const Dim& d = f.dims[dim];
    const int64_t n = d.member < 0 ? d.size : counts[d.member];
    Value::Array elements;
    for (int64_t i = 0; i < n; ++i) elements.push_back(array(f, dim + 1, counts));
    return {std::move(elements)};
  }

  Value element(const Field& f) {
    switch (f.kind) {
      case Kind::Int8:
        return {int64_t{take<int8_t>()}};
      case Kind::Int16:
        return {int64_t{take<int16_t>()}};
      case Kind::Int32:
      case Kind::Enum:
        return {int64_t{take<int32_t>()}};
      case Kind::Int64:
        return {take<int64_t>()};
      case Kind::Byte:
        return {int64_t{take<uint8_t>()}};
      case Kind::Float:
        return {std::bit_cast<float>(take<uint32_t>())};
      case Kind::Double:
        return {std::bit_cast<double>(take<uint64_t>())};
      case Kind::Boolean:
        return {take<uint8_t>() != 0};
      case Kind::String: {
        const auto length = take<uint32_t>();
        std::string text(reinterpret_cast<const char*>(p_), length - 1);
        p_ += length;
        return {std::move(text)};
      }
      case Kind::Struct:
        return structure(s_.types()[f.type]);
    }
    return {};
  }

  template <class Integer>
  Integer take() {
    const auto x = load_big_endian<Integer>(p_);
    p_ += sizeof x;
    return x;
  }

  const Schema& s_;
  const uint8_t* p_;
};

}  // namespace

Value Schema::decode(const Type& type, std::span<const uint8_t> bytes) const {
  if (std::string why = check(type, bytes, {.finite = false, .text = false}); !why.empty()) {
    throw std::invalid_argument(type.name + ": " + why);
  }
  return Decoder(*this, bytes.data() + 8).structure(type);
}

}  // namespace lab
