#include "core/util/json_text.h"

#include <nlohmann/json.hpp>

namespace lab {
namespace {

template <class Json>
std::string text(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace

std::string json_text(const nlohmann::json& value, int indent) { return text(value, indent); }
std::string json_text(const nlohmann::ordered_json& value, int indent) { return text(value, indent); }

nlohmann::json parse_json(std::string_view text) { return nlohmann::json::parse(text); }
nlohmann::json try_parse_json(std::string_view text) { return nlohmann::json::parse(text, nullptr, false); }

}  // namespace lab
