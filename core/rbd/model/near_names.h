// "did you mean": the names closest to one that was not found.
#pragma once

#include <string>
#include <vector>

namespace rbd {

// Up to `most` of `names`, closest edit distance first; names further than half their length are left out.
std::vector<std::string> nearNames(const std::string& name, const std::vector<std::string>& names,
                                   int most = 3);

// "KIND 'NAME' does not exist; near names: A, B" (or the number of names there are, when none is near).
std::string missingNameMessage(const std::string& kind, const std::string& name,
                               const std::vector<std::string>& names);

}  // namespace rbd
