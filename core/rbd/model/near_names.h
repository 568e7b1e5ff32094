// "did you mean": the names closest to one that was not found.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace rbd {

// Levenshtein distance: letters to insert, delete or replace.
int editDistance(std::string_view a, std::string_view b);

// Up to `most` of `names`, closest edit distance first; names further than half their length are left out.
std::vector<std::string> nearNames(const std::string& name, const std::vector<std::string>& names,
                                   int most = 3);

// "KIND 'NAME' does not exist; near names: A, B" (or the number of names there are, when none is near).
std::string missingNameMessage(const std::string& kind, const std::string& name,
                               const std::vector<std::string>& names);

}  // namespace rbd
