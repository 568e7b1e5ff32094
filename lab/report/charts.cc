#include "lab/report/charts.h"

#include <rbd/rbd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <utility>

#include "lab/evaluation/units.h"
#include "lab/page/page.h"
#include "lab/plot/draw.h"
#include "wire/protocol/loop_bins.h"

namespace lab::report {

using nlohmann::json;
using page::figure;
using plot::Chart;
using plot::Curve;
using plot::Ink;
using plot::Thinned;
using plot::ThinnedEvenly;

namespace {

/// `values` of the steps from `first` on, over time: one curve for each, without label and ink.
std::vector<Curve> curves_of(const Run& run, size_t count, size_t buckets,
                             const std::function<void(const RunStep&, std::vector<double>&)>& values,
                             size_t first = 0) {
  std::vector<Thinned> thinned(count, Thinned(run.steps.size() - first, buckets));
  std::vector<double> y(count);
  StepReader steps(run.steps);
  for (size_t k = first; k < run.steps.size(); ++k) {
    const RunStep& step = steps.at(k);
    values(step, y);
    for (size_t i = 0; i < count; ++i) thinned[i].add(time_of(step, run), y[i]);
  }
  std::vector<Curve> out;
  for (const Thinned& one : thinned) out.push_back(one.curve("", Ink::Blue));
  return out;
}

/// Shows a limit that the curve comes near to.
void show_level(Chart& chart, double level) {
  if (!std::isfinite(level)) return;
  const auto [low, high] = y_range(chart);
  const double size = std::max(high - low, 1e-9);
  if (level > high + 0.6 * size || level < low - 0.6 * size) return;
  chart.levels.push_back(level);
  chart.must_include_y.push_back(level);
}

}  // namespace

double time_of(const RunStep& step, const Run& run) { return static_cast<double>(step.state.step) * run.dt; }

std::string position_unit(const rbd::Model& model, int iv) { return slides(model, iv) ? "m" : "rad"; }

void ink(Curve& curve, size_t i) {
  curve.ink = plot::series_ink(i);
  curve.dashed = i / plot::kSeriesInks % 2 == 1;
}

size_t buckets_for(size_t curves) { return std::clamp<size_t>(12000 / std::max<size_t>(curves, 1), 60, 300); }

ChartGroup tracking_charts(const Run& run) {
  ChartGroup out;
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  std::vector<Curve> curves = curves_of(run, 2 * joints.size(), buckets_for(4 * joints.size()),
                                        [&](const RunStep& step, std::vector<double>& y) {
                                          for (size_t j = 0; j < joints.size(); ++j) {
                                            y[2 * j] = step.reference.q[joints[j].iq];
                                            y[2 * j + 1] = step.state.q[joints[j].iq];
                                          }
                                        });
  for (size_t j = 0; j < joints.size(); ++j) {
    const TrackedJoint& joint = joints[j];
    Chart chart{.title = joint.name + ": reference and actual position over time"};
    chart.curves = {std::move(curves[2 * j]), std::move(curves[2 * j + 1])};
    chart.curves[0].label = "reference";
    chart.curves[0].ink = Ink::Orange;
    chart.curves[1].label = "actual";
    chart.curves[0].width = 4;
    show_level(chart, run.model.lowerPositionLimit[joint.iq]);
    show_level(chart, run.model.upperPositionLimit[joint.iq]);
    out.panels.push_back({joint.name, position_unit(run.model, joint.iv), std::move(chart)});
  }
  Curve limit{.label = "limit, if it is near", .ink = Ink::Grey, .width = 1, .dashed = true};
  out.legend = {{.label = "reference", .ink = Ink::Orange, .width = 4}, {.label = "actual"}, limit};
  return out;
}

ChartGroup error_charts(const Run& run) {
  ChartGroup out;
  out.columns = 1;
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  Eigen::VectorXd e(run.model.nv);
  std::vector<double> size(joints.size());
  std::vector<Curve> curves = curves_of(run, joints.size(), buckets_for(4 * joints.size()),
                                        [&](const RunStep& step, std::vector<double>& y) {
                                          rbd::difference(run.model, step.state.q, step.reference.q, e);
                                          for (size_t j = 0; j < joints.size(); ++j) {
                                            y[j] = e[joints[j].iv];
                                            size[j] = std::max(size[j], std::abs(y[j]));
                                          }
                                        });
  // of many joints only the worst have inks of their own: those with an error of at least `least`
  constexpr size_t kOwnInks = plot::kSeriesInks;
  const bool many = joints.size() > kOwnInks;
  std::vector<double> ordered = size;
  std::sort(ordered.rbegin(), ordered.rend());
  const double least = many ? ordered[kOwnInks - 1] : 0;
  for (const char* const unit : {"rad", "m"}) {
    Chart chart{.title = "errors of the joints over time", .width = 1080, .height = 270};
    size_t inks = 0;
    for (size_t j = 0; j < joints.size(); ++j) {
      const bool has_ink = size[j] >= least && inks < kOwnInks;
      inks += has_ink;
      if (position_unit(run.model, joints[j].iv) != unit) continue;
      Curve one = std::move(curves[j]);
      one.label = joints[j].name;
      one.ink = Ink::Grey;
      if (has_ink) {
        ink(one, inks - 1);
        out.legend.push_back({.label = one.label, .ink = one.ink});
      } else {
        one.width = 0.6;
      }
      chart.curves.push_back(std::move(one));
    }
    if (chart.curves.empty()) continue;
    if (const auto [low, high] = y_range(chart); low < -run.band || high > run.band)
      chart.bands = {{-run.band, run.band}};
    out.panels.push_back({"Error of each joint", unit, std::move(chart)});
  }
  if (many)
    out.legend.push_back({.label = "the other joints, with smaller errors", .ink = Ink::Grey, .width = 0.6});
  return out;
}

ChartGroup effort_charts(const Run& run) {
  ChartGroup out;
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  // tau of a step is what led to it; none leads to step 0
  const size_t first = run.steps.size() > 1 ? 1 : 0;
  std::vector<Curve> curves = curves_of(
      run, joints.size(), buckets_for(4 * joints.size()),
      [&](const RunStep& step, std::vector<double>& y) {
        for (size_t j = 0; j < joints.size(); ++j) y[j] = step.state.tau[joints[j].iv];
      },
      first);
  for (size_t j = 0; j < joints.size(); ++j) {
    const TrackedJoint& joint = joints[j];
    Chart chart{.title = joint.name + ": effort over time"};
    chart.curves = {std::move(curves[j])};
    chart.curves[0].label = "effort";
    chart.must_include_x = {time_of(run.steps[0], run)};
    const double lower = run.model.lowerEffortLimit[joint.iv], upper = run.model.upperEffortLimit[joint.iv];
    show_level(chart, lower);
    show_level(chart, upper);
    std::string unit = unit_of("max_effort." + joint.name, run.model);
    if (std::isfinite(upper))
      unit += ", limit " + (lower == -upper ? "±" + figure(upper) : figure(lower) + " .. " + figure(upper));
    out.panels.push_back({joint.name, unit, std::move(chart)});
  }
  Curve limit{.label = "limit, if it is near", .ink = Ink::Grey, .width = 1, .dashed = true};
  out.legend = {{.label = "effort of the joint"}, limit};
  return out;
}

ChartGroup energy_charts(const Run& run) {
  ChartGroup out;
  constexpr size_t kBuckets = 250;
  Thinned gained(run.steps.size(), kBuckets), worked = gained, drifted = gained;
  std::optional<double> first;
  energy_balance(run, [&](double time, double energy, double work) {
    if (!first) first = energy;
    gained.add(time, energy - *first);
    worked.add(time, work);
    drifted.add(time, energy - *first - work);
  });
  if (!first) return out;
  Chart both{.title = "energy gained and work done over time", .width = 530, .height = 210};
  Chart rest{.title = "energy gained less work done over time", .width = 530, .height = 210};
  both.curves = {gained.curve("energy gained", Ink::Orange), worked.curve("work done", Ink::Blue)};
  both.curves[0].width = 4;
  rest.curves = {drifted.curve("drift", Ink::Red)};
  out.panels = {{"Energy gained, and work done", "J", std::move(both)},
                {"Difference of the two: drift", "J", std::move(rest)}};
  out.legend = {{.label = "energy gained", .ink = Ink::Orange, .width = 4},
                {.label = "work done"},
                {.label = "drift", .ink = Ink::Red}};
  out.columns = 2;
  return out;
}

ChartGroup tool_charts(const Run& run) {
  ChartGroup out;
  const std::string frame = tool_frame(run);
  if (frame.empty()) return out;
  const size_t n = run.steps.size();
  constexpr size_t kBuckets = 250, kPoints = 500;
  Thinned errors(n, kBuckets), angles(n, kBuckets);
  std::array<ThinnedEvenly, 2> wanted{ThinnedEvenly(n, kPoints), ThinnedEvenly(n, kPoints)}, actual = wanted;
  for_each_tool_step(run, [&](const ToolStep& step) {
    errors.add(step.time, step.error);
    angles.add(step.time, step.angle);
    for (int up : {1, 2}) {
      wanted[static_cast<size_t>(up - 1)].add(step.reference[0], step.reference[up]);
      actual[static_cast<size_t>(up - 1)].add(step.actual[0], step.actual[up]);
    }
  });
  const auto projection = [&](const std::string& caption, int up) {
    Chart chart{.title = "path of " + frame + ", " + caption, .width = 530, .height = 330};
    chart.x_label = "x (m)";
    chart.equal = true;
    chart.curves = {wanted[static_cast<size_t>(up - 1)].curve("", Ink::Orange),
                    actual[static_cast<size_t>(up - 1)].curve("", Ink::Blue)};
    chart.curves[0].width = 4;
    out.panels.push_back(
        {caption, std::string(1, static_cast<char>('x' + up)) + " in m over x", std::move(chart)});
  };
  projection("From above", 1);
  projection("From the side", 2);
  Chart error{.title = "distance of " + frame + " from its reference over time", .width = 530, .height = 210};
  Chart angle{.title = "angle of " + frame + " from its reference over time", .width = 530, .height = 210};
  error.curves = {errors.curve("distance", Ink::Blue)};
  angle.curves = {angles.curve("angle", Ink::Blue)};
  out.panels.push_back({"Distance from the reference", "m", std::move(error)});
  out.panels.push_back({"Angle from the reference", "rad", std::move(angle)});
  out.legend = {{.label = "reference", .ink = Ink::Orange, .width = 4}, {.label = "actual"}};
  out.columns = 2;
  return out;
}

ChartGroup loop_charts(const std::vector<Loops>& all) {
  ChartGroup out;
  for (const Loops& loops : all) {
    const double total =
        static_cast<double>(std::accumulate(loops.counts.begin(), loops.counts.end(), int64_t{0}));
    Chart chart{.title = loops.process + ": histogram of loop times", .x_label = "loop time (µs)"};
    chart.bars = chart.logarithmic_x = true;
    Curve bars;
    int first = 0, last = kLoopBins - 1;
    while (first < kLoopBins - 1 && loops.counts[static_cast<size_t>(first)] == 0) ++first;
    while (last > first && loops.counts[static_cast<size_t>(last)] == 0) --last;
    for (int bin = first; bin <= last; ++bin) {
      bars.x.push_back(std::max(0.5, static_cast<double>(loop_bin_start(bin))));  // the axis is logarithmic
      bars.y.push_back(100 * static_cast<double>(loops.counts[static_cast<size_t>(bin)]) / total);
    }
    bars.x.push_back(static_cast<double>(loop_bin_start(last + 1)));
    chart.curves = {bars};
    out.panels.push_back({loops.process, "% of " + figure(total, 8) + " loops", std::move(chart)});
  }
  return out;
}

int64_t loop_quantile(const Loops& loops, double share) {
  const int64_t total = std::accumulate(loops.counts.begin(), loops.counts.end(), int64_t{0});
  auto left = static_cast<int64_t>(share * static_cast<double>(total));
  for (int bin = 0; bin < kLoopBins; ++bin) {
    left -= loops.counts[static_cast<size_t>(bin)];
    if (left < 0) return loop_bin_start(bin + 1) - 1;
  }
  return loop_bin_start(kLoopBins);
}

json drawn(const ChartGroup& group) {
  if (group.panels.empty()) return nullptr;
  json legend = json::array(), panels = json::array();
  for (const Curve& one : group.legend)
    legend.push_back({{"key", plot::draw_key(one)}, {"label", page::breakable(one.label)}});
  for (const Panel& one : group.panels)
    panels.push_back(
        {{"caption", page::breakable(one.caption)}, {"unit", one.unit}, {"svg", plot::draw(one.chart)}});
  return {{"has_legend", !legend.empty()},
          {"legend", std::move(legend)},
          {"layout", group.columns == 1   ? " one"
                     : group.columns == 2 ? " two"
                                          : ""},
          {"panels", std::move(panels)}};
}

}  // namespace lab::report
