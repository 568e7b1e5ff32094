// The metrics of metrics.json that `expect` can bound. docs/metrics.md has a formula for each.
#pragma once
#include <rbd/model/model.h>

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"

namespace lab {

/// Whether less of a metric is better, as with errors; of efforts, speeds, margins, energies and counts neither is.
enum class Better { Less, Neither };

struct Metric {
  const char* name;
  const char* unit;
  const char* what;
  bool per_joint;  ///< also per joint: "max_error.elbow"
  Better better = Better::Less;
};
const std::vector<Metric>& metrics();
/// That of "max_error" or "max_error.elbow"; null if there is none.
const Metric* metric_of(const std::string& name);

/// Refuses (ExperimentError) an expected metric or joint that does not exist.
void check_expect(const Experiment&, const rbd::Model&);
/// The same for the tool's frame.
void check_evaluation(const Experiment&, const rbd::Model&);

/// The value of "max_error" or "max_error.elbow" in finished metrics; null if it has none.
nlohmann::json value_of(const nlohmann::json& metrics, const std::string& name);

/// A number of a JSON object; NaN if it has none there.
double number_in(const nlohmann::json& object, const std::string& key);

/// One per bound: metric, value, min, max, ok. A metric without a value fails.
nlohmann::json verdicts(const nlohmann::json& metrics, const std::map<std::string, Bound>& expect);

}  // namespace lab
