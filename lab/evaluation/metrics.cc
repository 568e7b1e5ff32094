#include "lab/evaluation/metrics.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lab/experiment/joints.h"

namespace lab {

using nlohmann::json;

const std::vector<Metric>& metrics() {
  constexpr Better kNeither = Better::Neither;
  static const std::vector<Metric> all = {
      {"max_error", "rad, m", "largest error of any joint at any step", true},
      {"mean_error", "rad, m", "mean absolute error over joints and steps", true},
      {"rms_error", "rad, m", "root of the mean squared error over joints and steps", true},
      {"final_error", "rad, m", "largest error of any joint at the last step", true},
      {"handbook_error", "rad, m",
       "mean over steps of norm(e) / nq; not a mean of errors, kept for comparison", false},
      {"settling_time", "s",
       "from when every joint stays within `evaluation.band` of its reference; null if one does not", true},
      {"max_tool_error", "m", "largest distance of the tool from where the reference has it", false},
      {"mean_tool_error", "m", "mean over the steps of the tool's distance from where the reference has it",
       false},
      {"rms_tool_error", "m", "root mean square of the tool's distance from where the reference has it",
       false},
      {"final_tool_error", "m", "distance of the tool from where the reference has it at the last step",
       false},
      {"max_tool_turn", "rad", "largest angle of the tool from how the reference has it", false},
      {"mean_tool_turn", "rad", "mean over the steps of the tool's angle from how the reference has it",
       false},
      {"rms_tool_turn", "rad", "root mean square of the tool's angle from how the reference has it", false},
      {"reach_count", "", "times that the reference came to rest at a new place", false, kNeither},
      {"reach_settling_max", "s",
       "longest time from the reference's arrival until the joint stays within the band; null if one does "
       "not",
       true},
      {"reach_settling_mean", "s",
       "mean over the reaches of the slowest joint's time from the reference's arrival until it stays within "
       "the band",
       true},
      {"overshoot_max", "rad, m", "farthest beyond the target, of joints whose way is longer than the band",
       true},
      {"overshoot_share_max", "", "largest overshoot as a share of the joint's way", true},
      {"steady_error_max", "rad, m", "largest error left in the last tenth of a rest", true},
      {"max_effort", "Nm, N", "largest effort of any joint", true, kNeither},
      {"rms_effort", "Nm, N", "root of the mean squared effort over joints and steps", true, kNeither},
      {"max_effort_share", "", "largest effort as a share of the joint's limit", true, kNeither},
      {"max_speed", "rad/s, m/s", "largest speed of any joint", true, kNeither},
      {"max_speed_share", "", "largest speed as a share of the joint's limit", true, kNeither},
      {"min_position_margin", "rad, m",
       "least distance from a position limit, negative beyond it; null if there are no limits", true,
       kNeither},
      {"energy_first", "J", "kinetic and potential energy at step 0", false, kNeither},
      {"energy_last", "J", "kinetic and potential energy at the last step", false, kNeither},
      {"work", "J", "work of the efforts, less what damping and friction took", false, kNeither},
      {"energy_drift", "J",
       "largest difference between energy gained and work; null unless every step is logged", false},
      {"energy_drift_relative", "", "energy drift as a share of the largest kinetic energy", false},
  };
  return all;
}

const Metric* metric_of(const std::string& name) {
  const std::string metric = name.substr(0, name.find('.'));
  for (const Metric& one : metrics())
    if (one.name == metric) return &one;
  return nullptr;
}

double number_in(const json& object, const std::string& key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : NAN;
}

void check_expect(const Experiment& e, const rbd::Model& model) {
  std::vector<std::string> names;
  for (const Metric& metric : metrics()) names.push_back(metric.name);
  for (const auto& [name, bound] : e.expect) {
    const size_t dot = name.find('.');
    const std::string base = name.substr(0, dot);
    const auto metric = std::find(names.begin(), names.end(), base);
    if (metric == names.end()) {
      const std::string near = did_you_mean(base, names);
      fail(e, "expect." + name,
           "there is no metric '" + base + "'" + (near.empty() ? "; there are " + list_of(names) : near));
    }
    if (dot == std::string::npos) continue;
    const std::string joint = name.substr(dot + 1);
    if (!metrics()[metric - names.begin()].per_joint)
      fail(e, "expect." + name, "'" + base + "' is not kept per joint");
    if (const std::string fault = joint_fault(model, joint); !fault.empty()) fail(e, "expect." + name, fault);
  }
}

void check_evaluation(const Experiment& e, const rbd::Model& model) {
  const std::string& frame = e.evaluation.frame;
  if (frame.empty() || model.existFrame(frame)) return;
  std::vector<std::string> names;
  for (const rbd::Frame& one : model.frames) names.push_back(one.name);
  fail(e, "evaluation.frame",
       "'" + model.name + "' has no frame '" + frame + "'" + did_you_mean(frame, names));
}

json value_of(const json& all, const std::string& metric) {
  const size_t dot = metric.find('.');
  if (dot == std::string::npos) return all.value(metric, json());
  for (const json& joint : all.at("joints"))
    if (joint.at("name") == metric.substr(dot + 1)) return joint.value(metric.substr(0, dot), json());
  return {};
}

json verdicts(const json& all, const std::map<std::string, Bound>& expect) {
  json list = json::array();
  for (const auto& [metric, bound] : expect) {
    json one{{"metric", metric}, {"value", value_of(all, metric)}};
    bool ok = one["value"].is_number();
    const double value = ok ? one["value"].get<double>() : 0;
    if (bound.min) {
      one["min"] = *bound.min;
      ok = ok && value >= *bound.min;
    }
    if (bound.max) {
      one["max"] = *bound.max;
      ok = ok && value <= *bound.max;
    }
    one["ok"] = ok;
    list.push_back(one);
  }
  return list;
}

}  // namespace lab
