#include <bit>
#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "core/util/big_endian.h"
#include "wire/schema/schema.h"

namespace lab {
namespace {

constexpr int kMaxDepth = 32;
// Elements that take no bytes (vectors of empty vectors, empty structs) a message may claim beyond its own
// length.
constexpr uint64_t kFreeElements = 65536;
constexpr uint64_t kMaxCount = uint64_t{1} << 31;
static_assert(std::endian::native == std::endian::little, "the finiteness masks below are in memory order");

template <class T>
T load(const uint8_t* p) {
  T x;
  std::memcpy(&x, p, sizeof x);
  return x;
}

int64_t load_int(const uint8_t* p, int width) {
  switch (width) {
    case 1:
      return static_cast<int8_t>(*p);
    case 2:
      return load_big_endian<int16_t>(p);
    case 4:
      return load_big_endian<int32_t>(p);
    default:
      return load_big_endian<int64_t>(p);
  }
}

// A number is not finite when its exponent bits are all ones; they sit in the first two bytes, big endian.
template <class T, T kExponent>
bool all_finite(const uint8_t* p, uint64_t n) {
  bool bad = false;
  for (uint64_t i = 0; i < n; ++i) bad |= (load<T>(p + i * sizeof(T)) & kExponent) == kExponent;
  return !bad;
}
constexpr uint64_t kDoubleExponent = 0xf07f;
constexpr uint32_t kFloatExponent = 0x807f;

std::string hex(int64_t v) {
  char s[24];
  std::snprintf(s, sizeof s, "0x%016" PRIx64, static_cast<uint64_t>(v));
  return s;
}

}  // namespace

// Runs a type's program over the bytes. On a fault it builds the reason on the way back up.
class Walker {
 public:
  Walker(const Schema& schema, std::span<const uint8_t> bytes, CheckOptions options)
      : s_(schema),
        p_(bytes.data()),
        end_(bytes.data() + bytes.size()),
        budget_(bytes.size() + kFreeElements),
        options_(options) {}

  bool walk(int type, int depth);
  uint64_t left() const { return static_cast<uint64_t>(end_ - p_); }
  std::string take_reason() { return std::move(reason_); }

 private:
  using Op = Schema::Op;

  bool fail(int type, const Op& op, const std::string& what, int64_t index = -1) {
    const Field& f = s_.types_[type].fields[op.field];
    std::string name = f.name;
    if (index >= 0 && !f.dims.empty()) name += "[" + std::to_string(index) + "]";
    reason_ = name + what;
    return false;
  }

  bool too_short(int type, const Op& op, uint64_t need) {
    return fail(type, op,
                " needs " + std::to_string(need) + " bytes, " + std::to_string(left()) + " are left");
  }

  // The number of elements of a variable array. Each outer dimension costs a container an element in the
  // generated decoder even when there is nothing inside, so those are paid from the budget.
  bool elements(int type, const Op& op, const int64_t* slots, uint64_t& n) {
    n = 1;
    for (uint32_t k = 0; k < op.ndims; ++k) {
      if (k > 0 && !pay(n))
        return fail(type, op, " has " + std::to_string(n) + " rows, more than the message can hold");
      const int64_t d = s_.dims_[op.dims + k];
      const uint64_t size = static_cast<uint64_t>(d >= 0 ? d : slots[-1 - d]);
      if (size > kMaxCount)
        return fail(type, op, " has " + std::to_string(size) + " elements, more than the message can hold");
      n *= size;  // no overflow: the product before is within the budget
    }
    return true;
  }

  bool pay(uint64_t n) {
    if (n > budget_) return false;
    budget_ -= n;
    return true;
  }

  bool fault_in_numbers(int type, const Op& op, uint64_t n);
  bool strings(int type, const Op& op, uint64_t n);

  const Schema& s_;
  const uint8_t* p_;
  const uint8_t* const end_;
  uint64_t budget_;
  const CheckOptions options_;
  std::string reason_;
};

bool Walker::walk(int type, int depth) {
  int64_t slots[32];
  const auto [begin, end] = s_.programs_[type];
  for (uint32_t i = begin; i < end; ++i) {
    const Op& op = s_.ops_[i];
    uint64_t n = op.fixed;
    if (op.ndims > 0 && !elements(type, op, slots, n)) return false;
    if (op.width > 0) {  // elements of a fixed size
      if (n > left() / op.width) return too_short(type, op, n * op.width);
      switch (op.code) {
        case Op::Count:
          slots[op.slot] = load_int(p_, op.width);
          if (slots[op.slot] < 0) return fail(type, op, " is " + std::to_string(slots[op.slot]));
          break;
        case Op::Bool:
          for (uint64_t k = 0; k < n; ++k) {
            if (p_[k] > 1)
              return fail(type, op, " is " + std::to_string(p_[k]) + ", a boolean is 0 or 1",
                          static_cast<int64_t>(k));
          }
          break;
        case Op::Double:
          if (options_.finite && !all_finite<uint64_t, kDoubleExponent>(p_, n))
            return fault_in_numbers(type, op, n);
          break;
        case Op::Float:
          if (options_.finite && !all_finite<uint32_t, kFloatExponent>(p_, n))
            return fault_in_numbers(type, op, n);
          break;
        default:
          break;
      }
      p_ += n * op.width;
      continue;
    }
    if (!pay(n))
      return fail(type, op, " has " + std::to_string(n) + " elements, more than the message can hold");
    if (op.code == Op::String) {
      if (!strings(type, op, n)) return false;
      continue;
    }
    if (depth >= kMaxDepth) return fail(type, op, " is nested deeper than " + std::to_string(kMaxDepth));
    for (uint64_t k = 0; k < n; ++k) {
      if (!walk(op.type, depth + 1)) return fail(type, op, "." + reason_, static_cast<int64_t>(k));
    }
  }
  return true;
}

bool Walker::strings(int type, const Op& op, uint64_t n) {
  for (uint64_t k = 0; k < n; ++k) {
    const auto index = static_cast<int64_t>(k);
    if (left() < 4) return too_short(type, op, 4);
    const int64_t length = load_int(p_, 4);
    p_ += 4;
    if (length < 1)
      return fail(type, op, " has length " + std::to_string(length) + ", with its NUL it is at least 1",
                  index);
    if (static_cast<uint64_t>(length) > left()) {
      return fail(type, op,
                  " has length " + std::to_string(length) + ", " + std::to_string(left()) + " bytes are left",
                  index);
    }
    const void* nul = options_.text ? std::memchr(p_, 0, static_cast<size_t>(length) - 1) : nullptr;
    if (nul)
      return fail(type, op, " has a NUL inside, at " + std::to_string(static_cast<const uint8_t*>(nul) - p_),
                  index);
    p_ += length;
    if (p_[-1] != 0) return fail(type, op, " does not end in NUL", index);
  }
  return true;
}

bool Walker::fault_in_numbers(int type, const Op& op, uint64_t n) {
  for (uint64_t k = 0; k < n; ++k) {
    const double x = op.code == Op::Double
                         ? std::bit_cast<double>(load_big_endian<uint64_t>(p_ + 8 * k))
                         : static_cast<double>(std::bit_cast<float>(load_big_endian<uint32_t>(p_ + 4 * k)));
    if (std::isfinite(x)) continue;
    return fail(type, op,
                std::isnan(x) ? " is nan"
                : x > 0       ? " is inf"
                              : " is -inf",
                static_cast<int64_t>(k));
  }
  return true;
}

std::string Schema::check(const Type& type, std::span<const uint8_t> bytes, CheckOptions options) const {
  if (bytes.size() < 8)
    return "only " + std::to_string(bytes.size()) + " bytes, the fingerprint alone takes 8";
  if (bytes.size() > kMaxCount) return std::to_string(bytes.size()) + " bytes are too long for any message";
  const int64_t fingerprint = load_int(bytes.data(), 8);
  if (fingerprint != type.fingerprint) {
    return "fingerprint " + hex(fingerprint) + " is not that of " + type.name + " (" + hex(type.fingerprint) +
           ")";
  }
  Walker walker(*this, bytes.subspan(8), options);
  if (!walker.walk(type.index, 0)) return walker.take_reason();
  if (walker.left() > 0) return std::to_string(walker.left()) + " bytes are left over at the end";
  return {};
}

}  // namespace lab
