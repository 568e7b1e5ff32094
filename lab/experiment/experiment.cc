#include "lab/experiment/experiment.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numeric>

namespace lab {

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
  // what is missing stands nowhere; the kind that needs it does
  if (auto it = experiment.where.find(key.substr(0, key.find('.')) + ".kind"); it != experiment.where.end())
    throw ExperimentError(it->second + ": " + key + ": " + message);
  throw ExperimentError((experiment.file.empty() ? "experiment" : experiment.file) + ": " + key + ": " +
                        message);
}

std::string number(double value) {
  char text[32];
  return {text, std::to_chars(text, text + sizeof text, value).ptr};
}

namespace {

size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), 0);
  for (size_t i = 0; i < a.size(); ++i) {
    size_t diagonal = row[0]++;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t substitute = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substitute});
    }
  }
  return row.back();
}

}  // namespace

std::string did_you_mean(const std::string& word, const std::vector<std::string>& candidates) {
  const auto leaf = [](const std::string& path) { return path.substr(path.rfind('.') + 1); };
  std::string best;
  size_t best_distance = std::max<size_t>(2, leaf(word).size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    // the same last word in another section is nearly as near as a slip of the pen
    const size_t distance =
        std::min(edit_distance(word, candidate), edit_distance(leaf(word), leaf(candidate)) + 1);
    if (distance < best_distance) best = candidate, best_distance = distance;
  }
  return best.empty() ? "" : "; did you mean '" + best + "'?";
}

std::string list_of(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

}  // namespace lab
