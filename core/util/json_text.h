// JSON from and to text, compiled once: the library's parser and writer are templates. Bytes that are not
// UTF-8 are written as printable() shows them, so that two names stay two.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace lab {

/// On one line, or with `indent` >= 0 on many. The members of an ordered_json keep their order; those of a json are sorted.
std::string json_text(const nlohmann::json& value, int indent = -1);
std::string json_text(const nlohmann::ordered_json& value, int indent = -1);

/// Throws nlohmann::json::parse_error, which says where.
nlohmann::json parse_json(std::string_view text);

/// A value for which is_discarded() holds when the text is not JSON.
nlohmann::json try_parse_json(std::string_view text);

}  // namespace lab
