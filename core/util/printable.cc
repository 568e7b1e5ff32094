#include "core/util/printable.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace lab {
namespace {

constexpr size_t kMaxLetters = 64, kHead = 40, kTail = 12;  // of a name
constexpr const char* kHex = "0123456789abcdef";

/// Of a character that utf8_length has accepted.
uint32_t code_point(std::string_view text, size_t at, size_t length) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[at + i]); };
  if (length == 1) return byte(0);
  uint32_t code = byte(0) & (0xffU >> (length + 1));
  for (size_t i = 1; i < length; ++i) code = code << 6 | (byte(i) & 0x3fU);
  return code;
}

/// Controls (C0, DEL, C1), line and paragraph separators, marks of direction, and the byte order mark.
bool is_hidden(uint32_t code) {
  struct Range {
    uint32_t first, last;
  };
  constexpr std::array<Range, 8> kHidden = {{{0, 0x1f},
                                             {0x7f, 0x9f},
                                             {0x61c, 0x61c},
                                             {0x200e, 0x200f},
                                             {0x2028, 0x202e},
                                             {0x2066, 0x2069},
                                             {0xfeff, 0xfeff},
                                             {0xfff9, 0xfffb}}};
  return std::any_of(kHidden.begin(), kHidden.end(),
                     [&](const Range& range) { return range.first <= code && code <= range.last; });
}

void append_escaped(std::string& out, uint32_t code) {
  switch (code) {
    case '\n':
      out += "\\n";
      return;
    case '\r':
      out += "\\r";
      return;
    case '\t':
      out += "\\t";
      return;
    default:
      out += "\\u";
      for (int shift = 12; shift >= 0; shift -= 4) out += kHex[code >> shift & 0xfU];
  }
}

template <class Hides>
std::string visible(std::string_view text, const Hides& hides) {
  std::string out;
  out.reserve(text.size());
  for (size_t at = 0; at < text.size();) {
    const size_t length = utf8_length(text, at);
    if (length == 0) {
      const auto byte = static_cast<unsigned char>(text[at++]);
      out += {'\\', 'x', kHex[byte >> 4], kHex[byte & 0xf]};
      continue;
    }
    const uint32_t code = code_point(text, at, length);
    if (hides(code))
      append_escaped(out, code);
    else
      out += text.substr(at, length);
    at += length;
  }
  return out;
}

}  // namespace

size_t utf8_length(std::string_view text, size_t at) {
  const auto byte = [&](size_t i) { return static_cast<unsigned char>(text[at + i]); };
  const unsigned lead = byte(0);
  if (lead < 0x80) return 1;
  const size_t length = lead < 0xc2 ? 0 : lead < 0xe0 ? 2 : lead < 0xf0 ? 3 : lead < 0xf5 ? 4 : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0U) != 0x80) return 0;
  const unsigned second = byte(1);  // overlong forms, surrogates, beyond U+10FFFF
  if ((lead == 0xe0 && second < 0xa0) || (lead == 0xed && second > 0x9f) || (lead == 0xf0 && second < 0x90) ||
      (lead == 0xf4 && second > 0x8f))
    return 0;
  return length;
}

std::string printable(std::string_view text) { return visible(text, is_hidden); }
std::string printable_lines(std::string_view text) {
  return visible(text, [](uint32_t code) { return code != '\n' && is_hidden(code); });
}

std::string printable_name(std::string_view name) {
  if (name.empty()) return "''";
  std::string shown = printable(name);
  std::vector<size_t> letters;  // where each begins
  for (size_t at = 0; at < shown.size(); at += utf8_length(shown, at)) letters.push_back(at);
  if (letters.size() <= kMaxLetters) return shown;
  return shown.substr(0, letters[kHead]) + ".." + shown.substr(letters[letters.size() - kTail]) + " (" +
         std::to_string(name.size()) + " bytes)";
}

}  // namespace lab
