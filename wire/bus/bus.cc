#include "wire/bus/bus.h"

#include <cstdlib>
#include <cstring>

#include "wire/bus/bus_fault.h"
#include "wire/bus/liblcm_bus.h"
#include "wire/bus/udpm.h"
#include "wire/schema/channel_name.h"

namespace lab {

std::string BusUrl::text() const {
  std::string s = provider + "://" + network;
  char separator = '?';
  for (const auto& [key, value] : options) {
    s += separator + key + "=" + value;
    separator = '&';
  }
  return s;
}

BusUrl parse_url(const std::string& url) {
  BusUrl out;
  const size_t colon = url.find("://");
  if (colon == std::string::npos || colon == 0) {
    throw BusError("bus URL '" + url +
                   "': expected provider://network, such as udpm://239.255.76.67:7667?ttl=0");
  }
  out.provider = url.substr(0, colon);
  const size_t question = url.find('?', colon);
  out.network = url.substr(colon + 3, question == std::string::npos ? question : question - colon - 3);
  for (size_t at = question; at != std::string::npos;) {
    const size_t next = url.find('&', at + 1);
    const std::string option = url.substr(at + 1, next == std::string::npos ? next : next - at - 1);
    const size_t equals = option.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw BusError("bus URL '" + url + "': option '" + option + "' should be key=value");
    }
    out.options.emplace_back(option.substr(0, equals), option.substr(equals + 1));
    at = next;
  }
  return out;
}

std::string default_url() {
  const char* env = std::getenv("LCM_DEFAULT_URL");
  return env && *env ? env : "udpm://239.255.76.67:7667?ttl=0";
}

std::unique_ptr<Bus> open_bus(const std::string& url, const BusOptions& options) {
  BusUrl parts = parse_url(url.empty() ? default_url() : url);
  const char* env = std::getenv("LAB_BUS");
  std::string backend = env ? env : "";
  std::erase_if(parts.options, [&](const auto& option) {
    if (option.first == "backend") backend = option.second;
    return option.first == "backend";
  });
  if (!backend.empty() && backend != "own" && backend != "liblcm") {
    throw BusError("bus backend '" + backend + "': own and liblcm exist");
  }
  BusOptions wanted = options;
  if (wanted.drop.probability == 0) wanted.drop = fault_from_env();
  if (parts.provider == "udpm" && backend != "liblcm") return open_udpm(parts, wanted);
  return open_liblcm(parts, wanted);
}

FaultHook fault_from_env() {
  const char* env = std::getenv("LAB_FAULT_DROP");
  if (!env || !*env) return {};
  char* end = nullptr;
  FaultHook hook;
  hook.probability = std::strtod(env, &end) / 100;
  if (*end == ',') hook.seed = std::strtoull(end + 1, &end, 0);
  if (end == env || *end != '\0' || !(hook.probability >= 0 && hook.probability <= 1)) {
    throw BusError("LAB_FAULT_DROP='" + std::string(env) +
                   "': expected percent or percent,seed, such as 5,1");
  }
  return hook;
}

void check_channel_name(std::string_view channel) {
  if (channel.empty() || channel.size() > kMaxChannelName) {
    throw std::invalid_argument("channel name '" + std::string(channel.substr(0, 80)) + "' must have 1 to " +
                                std::to_string(kMaxChannelName) + " bytes");
  }
  if (channel.find('\0') != std::string_view::npos)
    throw std::invalid_argument("channel name with a NUL inside");
}

}  // namespace lab
