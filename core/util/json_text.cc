#include "core/util/json_text.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/util/printable.h"

namespace lab {
namespace {

/// Only what is not UTF-8 made visible: JSON has its own way to write control characters.
std::string valid_utf8(const std::string& text) {
  std::string out;
  for (size_t at = 0; at < text.size();) {
    const size_t length = utf8_length(text, at);
    out += length > 0 ? text.substr(at, length) : printable(text.substr(at, 1));
    at += std::max<size_t>(length, 1);
  }
  return out;
}

/// A copy whose strings and keys are UTF-8.
template <class Json>
Json as_utf8(const Json& value) {
  if (value.is_string()) return valid_utf8(value.template get_ref<const std::string&>());
  if (value.is_array()) {
    Json out = Json::array();
    for (const Json& item : value) out.push_back(as_utf8(item));
    return out;
  }
  if (!value.is_object()) return value;
  Json out = Json::object();
  for (const auto& [key, item] : value.items()) out[valid_utf8(key)] = as_utf8(item);
  return out;
}

template <class Json>
std::string text(const Json& value, int indent) {
  try {
    return value.dump(indent, ' ');
  } catch (const typename Json::type_error&) {  // not UTF-8, which is rare
    return as_utf8(value).dump(indent, ' ');
  }
}

}  // namespace

std::string json_text(const nlohmann::json& value, int indent) { return text(value, indent); }
std::string json_text(const nlohmann::ordered_json& value, int indent) { return text(value, indent); }

nlohmann::json parse_json(std::string_view text) { return nlohmann::json::parse(text); }
nlohmann::json try_parse_json(std::string_view text) { return nlohmann::json::parse(text, nullptr, false); }

}  // namespace lab
