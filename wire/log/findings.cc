#include "wire/log/findings.h"

#include <fmt/format.h>

#include <algorithm>

namespace lab {

void LogFindings::add(LogDamage damage) {
  if (!damages.empty() && damage_count == static_cast<int64_t>(damages.size())) {
    LogDamage& last = damages.back();
    if (last.what == damage.what && last.offset + last.bytes == damage.offset) {
      last.bytes += damage.bytes;
      if (last.channel != damage.channel) last.channel.clear();
      if (last.step != damage.step) last.step = -1;
      return;
    }
  }
  ++damage_count;
  if (damages.size() < kMaxDamages) damages.push_back(std::move(damage));
}

std::string text_of(const LogDamage& damage) {
  std::string out = fmt::format("offset {}", damage.offset);
  if (damage.step >= 0) out += fmt::format(", step {}", damage.step);
  if (!damage.channel.empty()) out += ", " + damage.channel;
  return out + ": " + damage.what;
}

std::vector<std::string> lines_of(const LogFindings& findings, size_t most) {
  std::vector<std::string> lines;
  const size_t shown = std::min(most, findings.damages.size());
  for (size_t i = 0; i < shown; ++i) lines.push_back(text_of(findings.damages[i]));
  if (const int64_t more = findings.damage_count - static_cast<int64_t>(shown); more > 0)
    lines.push_back(fmt::format("and {} more damaged places", more));
  if (!findings.has_end)
    lines.emplace_back("there is no END: the log was cut off, or is still being written");
  return lines;
}

}  // namespace lab
