#include "lab/evaluation/units.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "lab/evaluation/metrics.h"
#include "lab/evaluation/tracking.h"

namespace lab {
namespace {

using nlohmann::json;

/// "rad/s, m/s": of joints that turn, and of those that slide. The same twice for all others.
std::pair<std::string, std::string> both(const std::string& unit) {
  const size_t comma = unit.find(", ");
  if (comma == std::string::npos || unit.find(", ", comma + 1) != std::string::npos) return {unit, unit};
  return {unit.substr(0, comma), unit.substr(comma + 2)};
}

bool depends_on_joint(const std::string& unit) { return unit.find(", ") != std::string::npos; }

/// Of the joints of one kind. A joint without a value counts where that means "never": the figure has none either.
Figure over(const json& joints, const std::string& metric, const std::vector<bool>& counts) {
  const bool mean = metric.starts_with("mean_"), rms = metric.starts_with("rms_"),
             least = metric.starts_with("min_");
  const bool never_counts = metric.find("settling") != std::string::npos;
  Figure out{NAN, "", ""};
  double sum = 0;
  int n = 0;
  for (size_t j = 0; j < joints.size(); ++j) {
    if (!counts[j]) continue;
    const double value = number_in(joints[j], metric);
    if (mean || rms) {
      sum += rms ? value * value : value;
      ++n;
    } else if (std::isnan(value)) {
      if (never_counts) return {NAN, "", joints[j]["name"]};
    } else if (std::isnan(out.value) || (least ? value < out.value : value > out.value)) {
      out.value = value;
      out.joint = joints[j]["name"];
    }
  }
  if (n > 0) out.value = rms ? std::sqrt(sum / n) : sum / n;
  return out;
}

/// By joint of joints_of(model): it slides.
std::vector<bool> sliding_joints(const rbd::Model& model) {
  std::vector<bool> out;
  for (const TrackedJoint& joint : joints_of(model)) out.push_back(slides(model, joint.iv));
  return out;
}

bool any(const std::vector<bool>& kinds, bool kind) {
  return std::find(kinds.begin(), kinds.end(), kind) != kinds.end();
}

}  // namespace

bool slides(const rbd::Model& model, int iv) {
  for (int j = 1; j < model.njoints; ++j)
    if (model.joints[j].nv() == 1 && model.joints[j].idx_v() == iv)
      return model.joints[j].kind() == rbd::JointKind::Prismatic;
  return false;
}

std::string chosen_unit(const std::string& unit, const rbd::Model& model, const std::string& joint) {
  const auto [turning, linear] = both(unit);
  if (turning == linear) return unit;
  for (const TrackedJoint& one : joints_of(model))
    if (one.name == joint) return slides(model, one.iv) ? linear : turning;
  const std::vector<bool> kinds = sliding_joints(model);
  if (!any(kinds, true)) return turning;
  return any(kinds, false) ? turning + " or " + linear : linear;
}

std::string unit_of(const std::string& metric, const rbd::Model& model) {
  const size_t dot = metric.find('.');
  const Metric* const known = metric_of(metric);
  if (known == nullptr) return "";
  return chosen_unit(known->unit, model, dot == std::string::npos ? "" : metric.substr(dot + 1));
}

std::vector<Figure> figures_of(const json& all, const std::string& metric, const rbd::Model& model) {
  const Metric* const known = metric_of(metric);
  const double value = number_in(all, metric);
  const auto joints = all.find("joints");
  const std::vector<bool> kinds = sliding_joints(model);
  const bool mixed = any(kinds, true) && any(kinds, false);
  if (known == nullptr || !known->per_joint || joints == all.end() || joints->empty()) {
    const bool has_unit =
        known != nullptr && !(depends_on_joint(known->unit) && mixed);  // of rad and m together, none
    return {{value, has_unit ? unit_of(metric, model) : "", ""}};
  }
  if (!depends_on_joint(known->unit) || !mixed) {
    const Figure one = over(*joints, metric, std::vector<bool>(joints->size(), true));
    return {{value, any(kinds, true) ? both(known->unit).second : both(known->unit).first, one.joint}};
  }
  return {figure_over(all, metric, model, false), figure_over(all, metric, model, true)};
}

Figure figure_over(const json& all, const std::string& metric, const rbd::Model& model, bool sliding) {
  std::vector<bool> counts = sliding_joints(model);
  if (!any(counts, !sliding)) return figures_of(all, metric, model).front();
  if (!sliding) counts.flip();
  Figure out = over(all["joints"], metric, counts);
  const Metric* const known = metric_of(metric);
  if (known != nullptr) out.unit = sliding ? both(known->unit).second : both(known->unit).first;
  return out;
}

Figure figure_of(const json& all, const std::string& metric, const rbd::Model& model) {
  const json value = value_of(all, metric);
  Figure out{value.is_number() ? value.get<double>() : NAN, unit_of(metric, model), ""};
  if (metric.find('.') != std::string::npos) return out;
  for (const Figure& one : figures_of(all, metric, model))
    if (one.value == out.value || (std::isnan(one.value) && std::isnan(out.value))) return one;
  return out;
}

}  // namespace lab
