#include <bit>

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
        return {int64_t{static_cast<int8_t>(take(1))}};
      case Kind::Int16:
        return {int64_t{static_cast<int16_t>(take(2))}};
      case Kind::Int32:
      case Kind::Enum:
        return {int64_t{static_cast<int32_t>(take(4))}};
      case Kind::Int64:
        return {static_cast<int64_t>(take(8))};
      case Kind::Byte:
        return {static_cast<int64_t>(take(1))};
      case Kind::Float:
        return {std::bit_cast<float>(static_cast<uint32_t>(take(4)))};
      case Kind::Double:
        return {std::bit_cast<double>(take(8))};
      case Kind::Boolean:
        return {take(1) != 0};
      case Kind::String: {
        const auto length = static_cast<size_t>(take(4));
        std::string text(reinterpret_cast<const char*>(p_), length - 1);
        p_ += length;
        return {std::move(text)};
      }
      case Kind::Struct:
        return structure(s_.types()[f.type]);
    }
    return {};
  }

  uint64_t take(int width) {
    uint64_t x = 0;
    for (int i = 0; i < width; ++i) x = x << 8 | *p_++;
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
