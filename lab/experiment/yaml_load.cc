#include "lab/experiment/yaml_load.h"

#include "lab/experiment/experiment.h"

namespace lab::yaml {
namespace {

/// Takes the values below a node off `left`; false when there are more, or deeper ones.
bool fits(const YAML::Node& node, int& left, int depth) {
  if (--left < 0 || depth > kMaxDepth) return false;
  for (const auto& item : node) {
    const bool fine = node.IsMap() ? fits(item.first, left, depth + 1) && fits(item.second, left, depth + 1)
                                   : fits(item, left, depth + 1);
    if (!fine) return false;
  }
  return true;
}

}  // namespace

YAML::Node load(const std::string& text, const std::string& place) {
  YAML::Node root = YAML::Load(text);
  int left = kMaxValues;
  if (!fits(root, left, 0))
    throw ExperimentError(place + ": stands for more than " + std::to_string(kMaxValues) + " values or " +
                          std::to_string(kMaxDepth) +
                          " levels once its aliases are replaced: write less of it");
  return root;
}

}  // namespace lab::yaml
