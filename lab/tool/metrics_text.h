// Metrics as lines for people, as `lab-experiment evaluate` prints them.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lab {

/// `evaluated` is what evaluate() returns: a table of the joints, a line each for the tool, the reaches, every verdict.
std::string metrics_text(const nlohmann::json& evaluated);

}  // namespace lab
