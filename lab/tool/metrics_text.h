// Metrics as lines for people, as `lab-experiment evaluate` prints them.
#pragma once
#include <rbd/model/model.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

namespace lab {

/// `evaluated` is what evaluate() returns for this robot: a table of the joints that turn and one of those that slide, a line each
/// for the tool, the reaches, every verdict. A figure has one unit.
std::string metrics_text(const nlohmann::json& evaluated, const rbd::Model&);

}  // namespace lab
