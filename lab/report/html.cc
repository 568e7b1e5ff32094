#include "lab/report/html.h"

#include <cmath>
#include <cstdint>
#include <cstdio>

#include "core/util/number.h"
#include "lab/report/style.h"

namespace lab::report {

std::string escape(std::string_view text) {
  std::string out;
  for (char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
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

std::string figure(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  std::string out = rounded(value == 0 ? 0.0 : value, digits);  // no -0
  if (out[0] == '-') out.replace(0, 1, "−");
  return out;
}

std::string Table::html() const {
  const auto row = [&](const std::vector<std::string>& cells, const char* tag) {
    std::string out = "<tr>";
    for (size_t i = 0; i < cells.size(); ++i)
      out +=
          std::string("<") + tag + (i < text_columns ? " class=\"w\">" : ">") + cells[i] + "</" + tag + ">";
    return out + "</tr>\n";
  };
  std::string out = std::string("<div class=\"scroll\"><table") + (narrow ? " class=\"narrow\"" : "") + ">\n";
  if (!head.empty()) out += "<thead>" + row(head, "th") + "</thead>\n";
  out += "<tbody>\n";
  for (const auto& cells : rows) out += row(cells, "td");
  return out + "</tbody></table></div>\n";
}

std::string section(const std::string& heading, const std::string& body) {
  return "<section>\n<h2>" + escape(heading) + "</h2>\n" + body + "</section>\n";
}

std::string missing(const std::string& why) { return "<p class=\"missing\">" + escape(why) + "</p>\n"; }

std::string page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
         "<meta name=\"color-scheme\" content=\"light dark\">\n<title>" +
         escape(title) + "</title>\n<style>\n" + kStyle + "</style>\n</head>\n<body>\n<main>\n" + body +
         "</main>\n</body>\n</html>\n";
}

}  // namespace lab::report
