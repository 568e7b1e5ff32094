#include "lab/page/page.h"

#include <charconv>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "core/util/number.h"
#include "lab/page/template.h"

namespace lab::page {

const Texts& embedded();

std::string document(const std::string& title, const std::string& body) {
  return fill(embedded(), "page.html",
              {{"title", title}, {"style", std::string(embedded().at("style.css"))}, {"body", body}});
}

std::string figure(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) value = 0;  // no -0
  const bool whole = std::abs(value) < 1e6 && std::abs(value) >= std::pow(10, digits) - 0.5;
  std::string out = whole ? std::to_string(std::llround(value)) : rounded(value, digits);
  if (out[0] == '-') out.replace(0, 1, "−");
  return out;
}

std::string short_figure(const std::string& text) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && stop == text.data() + text.size() ? figure(value) : text;
}

std::string breakable(const std::string& name) {
  constexpr size_t kShort = 20;
  std::string out;
  for (const char c : escape(name)) {
    out += c;
    if (name.size() > kShort && (c == '_' || c == '.' || c == '/')) out += "<wbr/>";
  }
  return out;
}

std::string base64(std::string_view bytes) {
  constexpr char kLetters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve(bytes.size() * 4 / 3 + 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t three = 0;
    for (size_t k = 0; k < 3; ++k)
      three = three << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) out += i + k <= bytes.size() ? kLetters[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

}  // namespace lab::page
