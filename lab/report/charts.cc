#include "lab/report/charts.h"

#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

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

namespace {

Curve curve(const std::string& label, const std::vector<double>& x, std::vector<double> y, Ink ink,
            size_t buckets) {
  Curve out{.label = label, .x = x, .y = std::move(y), .ink = ink};
  thin(out, buckets);
  return out;
}

/// One value per step.
template <class F>
std::vector<double> series(const Run& run, F&& value) {
  std::vector<double> out;
  for (size_t k = 0; k < run.states.size(); ++k) out.push_back(value(k));
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

std::vector<double> times(const Run& run) {
  return series(run, [&](size_t k) { return static_cast<double>(run.states[k].step) * run.dt; });
}

std::vector<std::vector<double>> errors(const Run& run) {
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  std::vector<std::vector<double>> out(joints.size());
  Eigen::VectorXd e(run.model.nv);
  for (size_t k = 0; k < run.states.size(); ++k) {
    rbd::difference(run.model, run.states[k].q, run.references[k].q, e);
    for (size_t j = 0; j < joints.size(); ++j) out[j].push_back(e[joints[j].iv]);
  }
  return out;
}

std::string position_unit(const rbd::Model& model, int iv) { return slides(model, iv) ? "m" : "rad"; }

void ink(Curve& curve, size_t i) {
  curve.ink = plot::series_ink(i);
  curve.dashed = i / plot::kSeriesInks % 2 == 1;
}

size_t buckets_for(size_t curves) { return std::clamp<size_t>(12000 / std::max<size_t>(curves, 1), 60, 300); }

ChartGroup tracking_charts(const Run& run) {
  ChartGroup out;
  const std::vector<double> t = times(run);
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  const size_t buckets = buckets_for(4 * joints.size());
  for (const TrackedJoint& joint : joints) {
    Chart chart{.title = joint.name + ": reference and actual position over time"};
    chart.curves = {
        curve("reference", t, series(run, [&](size_t k) { return run.references[k].q[joint.iq]; }),
              Ink::Orange, buckets),
        curve("actual", t, series(run, [&](size_t k) { return run.states[k].q[joint.iq]; }), Ink::Blue,
              buckets)};
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
  const std::vector<double> t = times(run);
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  const std::vector<std::vector<double>> e = errors(run);
  // of many joints only the worst have inks of their own: those with an error of at least `least`
  constexpr size_t kOwnInks = plot::kSeriesInks;
  const bool many = joints.size() > kOwnInks;
  std::vector<double> size;
  for (const auto& one : e) {
    const auto [low, high] = std::minmax_element(one.begin(), one.end());
    size.push_back(std::max(std::abs(*low), std::abs(*high)));
  }
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
      Curve one = curve(joints[j].name, t, e[j], Ink::Grey, buckets_for(4 * joints.size()));
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
  const std::vector<double> t = times(run);
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  for (const TrackedJoint& joint : joints) {
    Chart chart{.title = joint.name + ": effort over time"};
    // tau of a step is what led to it; none leads to step 0
    std::vector<double> x(t.begin() + (t.size() > 1), t.end()), tau;
    for (size_t k = t.size() > 1; k < t.size(); ++k) tau.push_back(run.states[k].tau[joint.iv]);
    chart.curves = {curve("effort", x, std::move(tau), Ink::Blue, buckets_for(4 * joints.size()))};
    chart.must_include_x = {t.front()};
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
  const EnergyBalance energy = energy_balance(run);
  if (energy.energy.empty()) return out;
  const std::vector<double> t = times(run);
  std::vector<double> gained, drift;
  for (size_t k = 0; k < t.size(); ++k) {
    gained.push_back(energy.energy[k] - energy.energy[0]);
    drift.push_back(gained[k] - energy.work[k]);
  }
  Chart both{.title = "energy gained and work done over time", .width = 530, .height = 210};
  Chart rest{.title = "energy gained less work done over time", .width = 530, .height = 210};
  both.curves = {curve("energy gained", t, gained, Ink::Orange, 250),
                 curve("work done", t, energy.work, Ink::Blue, 250)};
  both.curves[0].width = 4;
  rest.curves = {curve("drift", t, drift, Ink::Red, 250)};
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
  const ToolPath path = tool_path(run);
  if (path.frame.empty()) return out;
  const std::vector<double> t = times(run);
  const auto projection = [&](const std::string& caption, int right, int up) {
    Chart chart{.title = "path of " + path.frame + ", " + caption, .width = 530, .height = 330};
    chart.x_label = std::string(1, static_cast<char>('x' + right)) + " (m)";
    chart.equal = true;
    for (const auto* points : {&path.reference, &path.actual}) {
      Curve one{.label = "", .ink = points == &path.actual ? Ink::Blue : Ink::Orange};
      if (points == &path.reference) one.width = 4;
      for (const Eigen::Vector3d& p : *points) {
        one.x.push_back(p[right]);
        one.y.push_back(p[up]);
      }
      thin_evenly(one, 500);
      chart.curves.push_back(std::move(one));
    }
    out.panels.push_back(
        {caption,
         std::string(1, static_cast<char>('x' + up)) + " in m over " + static_cast<char>('x' + right),
         std::move(chart)});
  };
  projection("From above", 0, 1);
  projection("From the side", 0, 2);
  Chart error{
      .title = "distance of " + path.frame + " from its reference over time", .width = 530, .height = 210};
  Chart angle{
      .title = "angle of " + path.frame + " from its reference over time", .width = 530, .height = 210};
  error.curves = {curve("distance", t, path.error, Ink::Blue, 250)};
  angle.curves = {curve("angle", t, path.angle, Ink::Blue, 250)};
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
