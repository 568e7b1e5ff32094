#include "wire/schema/guard.h"

#include <bit>
#include <cstring>

#include "core/util/big_endian.h"
#include "lcmtypes/texts.h"
#include "wire/schema/channel_name.h"

namespace lab {
namespace {

constexpr size_t kMaxReason = 500;
constexpr size_t kHeadBytes = 32;  // fingerprint, utime, run, step

}  // namespace

const Schema& lab_schema() {
  static const Schema schema = [] {
    std::vector<Source> sources;
    for (const std::string& text : lcm_texts()) sources.push_back({"lcmtypes", text});
    return Schema(std::move(sources));
  }();
  return schema;
}

Guard::Guard(std::string prefix) : prefix_(std::move(prefix)), rules_(kChannels) {
  const Schema& schema = lab_schema();
  for (const ChannelRow& r : kChannelTable) {
    Rule& rule = rules_[static_cast<size_t>(r.id)];
    rule.type = schema.find(r.type);
    if (!rule.type) throw SchemaError("lcmtypes has no " + std::string(r.type));
    if (schema.fixed_offset(*rule.type, "step") != 24) {
      throw SchemaError(std::string(r.type) + " must start with int64_t utime, run, step");
    }
    if (!r.nq_field.empty()) rule.nq_offset = schema.fixed_offset(*rule.type, r.nq_field);
    if (!r.nv_field.empty()) rule.nv_offset = schema.fixed_offset(*rule.type, r.nv_field);
  }
}

void Guard::set_sizes(int nq, int nv) {
  nq_ = nq;
  nv_ = nv;
}

Verdict Guard::check(std::string_view channel, std::span<const uint8_t> bytes) const {
  if (const auto id = channel_of(channel, prefix_)) return check(*id, bytes);
  Verdict verdict;
  verdict.kind = Verdict::Refused;
  verdict.reason = std::string(channel.substr(0, kMaxChannelName)) + ": not a channel of the lab";
  return verdict;
}

Verdict Guard::check(Channel channel, std::span<const uint8_t> bytes) const {
  const ChannelRow& r = row(channel);
  const Rule& rule = rules_[static_cast<size_t>(channel)];
  Verdict verdict;
  const auto refuse = [&](const std::string& why) {
    verdict.kind = Verdict::Refused;
    verdict.reason = (std::string(r.name) + ": " + why).substr(0, kMaxReason);  // `why` may quote the message
    return verdict;
  };
  if (bytes.size() > r.max_bytes) {
    return refuse(std::to_string(bytes.size()) + " bytes, at most " + std::to_string(r.max_bytes) +
                  " are allowed");
  }
  if (std::string why = lab_schema().check(*rule.type, bytes); !why.empty()) return refuse(why);
  verdict.head = {load_big_endian<int64_t>(&bytes[8]), load_big_endian<int64_t>(&bytes[16]),
                  load_big_endian<int64_t>(&bytes[24])};
  static_assert(kHeadBytes == 32);
  // the run is checked before the sizes: another robot's message is foreign
  if (run_ != 0 && verdict.head.run != run_ && !(r.any_run && verdict.head.run == 0)) {
    verdict.kind = Verdict::Foreign;
    verdict.reason = std::string(r.name) + ": run " + std::to_string(verdict.head.run) + ", this one is " +
                     std::to_string(run_);
    return verdict;
  }
  // empty for no rule and for equal sizes
  const auto size_fault = [&](int offset, int wanted, std::string_view field) -> std::string {
    if (offset < 0 || wanted < 0) return {};
    const int32_t seen = load_big_endian<int32_t>(&bytes[offset]);
    if (seen == wanted) return {};
    return std::string(field) + " is " + std::to_string(seen) + ", this robot has " + std::to_string(wanted);
  };
  if (std::string why = size_fault(rule.nq_offset, nq_, r.nq_field); !why.empty()) return refuse(why);
  if (std::string why = size_fault(rule.nv_offset, nv_, r.nv_field); !why.empty()) return refuse(why);
  return verdict;
}

}  // namespace lab
