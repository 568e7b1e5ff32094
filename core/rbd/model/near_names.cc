#include "rbd/model/near_names.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace rbd {
// One row of the table of distances between all beginnings of a and b at a time.
int editDistance(std::string_view a, std::string_view b) {
  std::vector<int> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const int above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] != b[j - 1])});
      diagonal = above;
    }
  }
  return row.back();
}

std::vector<std::string> nearNames(const std::string& name, const std::vector<std::string>& names, int most) {
  std::vector<std::pair<int, std::string>> hits;
  for (const std::string& other : names) {
    const int longest = static_cast<int>(std::max(name.size(), other.size()));
    const bool contains = name.size() > 2 && other.find(name) != std::string::npos;
    const int distance = contains ? 1 : editDistance(name, other);
    if (2 * distance <= longest) hits.emplace_back(distance, other);
  }
  std::stable_sort(hits.begin(), hits.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::string> out;
  for (const auto& hit : hits) {
    if (static_cast<int>(out.size()) == most) break;
    if (std::find(out.begin(), out.end(), hit.second) == out.end()) out.push_back(hit.second);
  }
  return out;
}

std::string missingNameMessage(const std::string& kind, const std::string& name,
                               const std::vector<std::string>& names) {
  std::string text = kind + " '" + name + "' does not exist; ";
  const std::vector<std::string> near = nearNames(name, names);
  if (near.empty()) return text + "none of the " + std::to_string(names.size()) + " names is near";
  text += "near names: ";
  for (std::size_t i = 0; i < near.size(); ++i) text += (i ? ", " : "") + near[i];
  return text;
}

}  // namespace rbd
