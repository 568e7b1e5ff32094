#include "lab/experiment/experiment.h"

#include <rbd/model/near_names.h>

#include <algorithm>
#include <cmath>

namespace lab {

Experiment::Experiment() = default;
Experiment::~Experiment() = default;
Experiment::Experiment(const Experiment&) = default;
Experiment::Experiment(Experiment&&) noexcept = default;
Experiment& Experiment::operator=(const Experiment&) = default;
Experiment& Experiment::operator=(Experiment&&) noexcept = default;

void Experiment::keep_running() {
  simulator.clock = "realtime";
  simulator.duration = kUntilEnded;
}

int64_t Experiment::last_step() const { return std::llround(simulator.duration / simulator.dt); }

bool Experiment::operator==(const Experiment& o) const {
  return name == o.name && seed == o.seed && ready == o.ready && deadline == o.deadline && robot == o.robot &&
         simulator == o.simulator && planner == o.planner && controller == o.controller &&
         logger == o.logger && renderer == o.renderer && faults == o.faults && safety == o.safety &&
         evaluation == o.evaluation && processes == o.processes && expect == o.expect;
}

void fail(const Experiment& experiment, const std::string& key, const std::string& message) {
  // a fault inside a key (expect.max_error.max) is reported where the nearest given key stands
  for (std::string at = key;; at.resize(at.find_last_of(".["))) {
    if (auto it = experiment.where.find(at); it != experiment.where.end())
      throw ExperimentError(it->second + ": " + key + ": " + message);
    if (at.find_first_of(".[") == std::string::npos) break;
  }
  // a missing key has no line; the kind that needs it has one
  if (auto it = experiment.where.find(key.substr(0, key.find('.')) + ".kind"); it != experiment.where.end())
    throw ExperimentError(it->second + ": " + key + ": " + message);
  throw ExperimentError((experiment.file.empty() ? "experiment" : experiment.file) + ": " + key + ": " +
                        message);
}

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const auto leaf = [](const std::string& path) { return path.substr(path.rfind('.') + 1); };
  std::string best;
  int best_distance = std::max(2, static_cast<int>(leaf(word).size() / 3)) + 1;
  for (const std::string& candidate : candidates) {
    // the same last word in another section is nearly as near as a typing error
    const int distance =
        std::min(rbd::editDistance(word, candidate), rbd::editDistance(leaf(word), leaf(candidate)) + 1);
    if (distance >= best_distance) continue;
    best = candidate;
    best_distance = distance;
  }
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace lab
