// The .lcm texts of this folder, embedded at build time.
#pragma once
#include <string>
#include <vector>

namespace lab {

/// The text of every .lcm file of this folder, sorted by file name. Embedded at build time.
const std::vector<std::string>& lcm_texts();

}  // namespace lab
