#include "wire/protocol/publishers.h"

#include <fmt/format.h>

#include <algorithm>

namespace lab {

std::string address_text(uint64_t address) {
  return fmt::format("{}.{}.{}.{}:{}", address >> 40 & 255, address >> 32 & 255, address >> 24 & 255,
                     address >> 16 & 255, address & 65535);
}

Publishers::Publishers(std::string own, int64_t nonce, std::vector<std::string> guests, Check check)
    : own_(std::move(own)), nonce_(nonce), guests_(std::move(guests)), check_(std::move(check)) {}

std::string_view Publishers::owner_of(Channel channel) {
  switch (row(channel).publisher) {
    case Publisher::Simulator:
      return kSimulator;
    case Publisher::Planner:
      return kPlanner;
    case Publisher::Controller:
      return kController;
    case Publisher::Renderer:
      return kRenderer;
    case Publisher::Named:
    case Publisher::Anybody:
    case Publisher::Nobody:
      return {};
  }
  return {};
}

bool Publishers::is_pinned(std::string_view name, uint64_t address, Micros now) {
  const auto pin = pins_.find(name);
  if (pin == pins_.end() || pin->second.address != address) return false;
  pin->second.heard = now;
  return true;
}

Claim Publishers::claim(const std::string& name, uint64_t address, Micros now) {
  if (!check_) return Claim::Unknown;
  std::erase_if(asked_, [now](const auto& asked) { return now - asked.second >= kAskAgain; });
  if (asked_.contains(address) || asked_.size() >= kMaxAsked) return Claim::Stranger;
  const Claim owner = check_(name, address);
  if (owner == Claim::Stranger) asked_[address] = now;
  return owner;
}

std::string Publishers::process(const std::string& name, int64_t nonce, uint64_t address, Micros now) {
  if (address == 0) return nonce == nonce_ ? "" : fmt::format("a {} of another lab", name);
  if (is_pinned(name, address, now)) return {};
  if (name == own_) return fmt::format("{} is another process named {}", address_text(address), name);
  const auto known = pins_.find(name);
  const bool guest = nonce == 0 && (known == pins_.end() || known->second.guest) &&
                     std::find(guests_.begin(), guests_.end(), name) != guests_.end();
  if (nonce != nonce_ && !guest)
    return fmt::format("{} is the {} of another lab", address_text(address), name);
  const Claim owner = claim(name, address, now);
  if (owner == Claim::Stranger)
    return fmt::format("{} is not the {} that the supervisor started", address_text(address), name);
  if (known == pins_.end()
          ? pins_.size() >= kMaxNames
          : owner != Claim::Ours && (name == kSimulator || now - known->second.heard < kSilence))
    return fmt::format("{} is a second {}", address_text(address), name);
  pins_[name] = {address, now, guest};
  return {};
}

std::string Publishers::message(Channel channel, std::string_view name, uint64_t address, Micros now) {
  if (address == 0 || is_pinned(name, address, now)) return {};
  const bool resent =
      channel == Channel::Reference || channel == Channel::Command || channel == Channel::Event;
  if (resent && own_ != kSimulator && is_pinned(kSimulator, address, now)) return {};
  return fmt::format("{} is not this lab's {}", address_text(address), name);
}

}  // namespace lab
