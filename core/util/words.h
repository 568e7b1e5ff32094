// Words in one text, with blanks between them, as rows of tables have them.
#pragma once
#include <algorithm>
#include <string_view>

namespace lab {

/// Whether a word is one of them.
inline bool lists(std::string_view words, std::string_view word) {
  for (size_t at = 0; at <= words.size();) {
    const size_t end = std::min(words.find(' ', at), words.size());
    if (words.substr(at, end - at) == word) return true;
    at = end + 1;
  }
  return false;
}

}  // namespace lab
