#include "lab/evaluation/reaches.h"

#include <rbd/rbd.h>

#include <cmath>

#include "lab/evaluation/running_stats.h"
#include "lab/evaluation/tracking.h"

namespace lab {
namespace {

using nlohmann::json;

constexpr double kStill = 1e-9;  // rad/s, m/s: polynomials end at rest up to rounding

double largest(const Eigen::VectorXd& x) {
  double size = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i) size = std::max(size, std::abs(x[i]));
  return size;
}

/// By step: the reference rests.
std::vector<bool> resting(const Run& run) {
  const size_t n = run.references.size();
  std::vector<bool> out(n);
  Eigen::VectorXd moved(run.model.nv);
  const auto same = [&](size_t a, size_t b) {
    rbd::difference(run.model, run.references[a].q, run.references[b].q, moved);
    return largest(moved) <= kStill;
  };
  for (size_t k = 0; k < n; ++k) {
    if (largest(run.references[k].v) > kStill) continue;
    out[k] = k + 1 == n || same(k, k + 1) || (k > 0 && out[k - 1] && same(k - 1, k));
  }
  return out;
}

/// `beyond`: q - target by step, from arrival to end.
Reach::Joint joint_of_reach(const Run& run, const Reach& reach, double displacement,
                            const std::vector<double>& beyond) {
  Reach::Joint out;
  out.displacement = displacement;
  size_t inside_since = beyond.size();  // of the last stretch
  while (inside_since > 0 && std::abs(beyond[inside_since - 1]) <= run.band) --inside_since;
  out.settling = inside_since == beyond.size()
                     ? NAN
                     : static_cast<double>(run.states[reach.arrival + inside_since].step -
                                           run.states[reach.arrival].step) *
                           run.dt;
  if (std::abs(displacement) > run.band) {
    for (double b : beyond) out.overshoot = std::max(out.overshoot, displacement > 0 ? b : -b);
    out.overshoot_share = out.overshoot / std::abs(displacement);
  } else {
    out.overshoot = out.overshoot_share = NAN;
  }
  const size_t last = std::max<size_t>(1, beyond.size() / 10);
  double sum = 0;
  for (size_t i = beyond.size() - last; i < beyond.size(); ++i) sum += beyond[i];
  out.steady_error = std::abs(sum / static_cast<double>(last));
  return out;
}

/// Over several reaches. NaN: some reach has no value, or there are none.
struct ReachStats {
  double settling_max, settling_mean, overshoot_max, overshoot_share_max, steady_error_max;
};

/// Of one joint, or, with -1, of the worst joint of each reach.
ReachStats stats_of(const std::vector<Reach>& all, int joint) {
  ReachStats out{0, 0, NAN, NAN, 0};
  const auto larger = [](double a, double b) {
    return std::isnan(a) || b > a ? b : a;  // a number, if there is one
  };
  for (const Reach& reach : all) {
    double slowest = 0;  // NaN: a joint does not settle
    for (size_t j = 0; j < reach.joints.size(); ++j) {
      if (joint >= 0 && j != static_cast<size_t>(joint)) continue;
      const Reach::Joint& one = reach.joints[j];
      slowest = std::isnan(slowest) || std::isnan(one.settling) ? NAN : std::max(slowest, one.settling);
      out.overshoot_max = larger(out.overshoot_max, one.overshoot);
      out.overshoot_share_max = larger(out.overshoot_share_max, one.overshoot_share);
      out.steady_error_max = std::max(out.steady_error_max, one.steady_error);
    }
    out.settling_max =
        std::isnan(out.settling_max) || std::isnan(slowest) ? NAN : std::max(out.settling_max, slowest);
    out.settling_mean += slowest / static_cast<double>(all.size());
  }
  if (all.empty()) out.settling_max = out.settling_mean = out.steady_error_max = NAN;
  return out;
}

void put_reach_stats(json& out, const std::vector<Reach>& all, int joint) {
  const ReachStats stats = stats_of(all, joint);
  put(out, "reach_settling_max", stats.settling_max);
  put(out, "reach_settling_mean", stats.settling_mean);
  put(out, "overshoot_max", stats.overshoot_max);
  put(out, "overshoot_share_max", stats.overshoot_share_max);
  put(out, "steady_error_max", stats.steady_error_max);
}

json reach_json(const Run& run, const Reach& reach, const std::vector<TrackedJoint>& joints) {
  const auto time = [&](size_t k) { return static_cast<double>(run.states[k].step) * run.dt; };
  json out;
  put_reach_stats(out, {reach}, -1);
  out.erase("reach_settling_mean");
  out["begin"] = time(reach.begin);
  out["arrival"] = time(reach.arrival);
  out["end"] = time(reach.end);
  for (size_t j = 0; j < joints.size(); ++j) {
    json one{{"name", joints[j].name}};
    put(one, "way", reach.joints[j].displacement);
    put(one, "settling", reach.joints[j].settling);
    put(one, "overshoot", reach.joints[j].overshoot);
    put(one, "overshoot_share", reach.joints[j].overshoot_share);
    put(one, "steady_error", reach.joints[j].steady_error);
    out["joints"].push_back(one);
  }
  return out;
}

}  // namespace

std::vector<Reach> reaches(const Run& run) {
  std::vector<Reach> all;
  if (run.states.empty()) return all;
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  const std::vector<bool> rests = resting(run);
  Eigen::VectorXd displacement(run.model.nv), e(run.model.nv);
  size_t from = 0;  // the last step at the place before
  for (size_t k = 1; k < rests.size(); ++k) {
    if (!rests[k]) continue;
    rbd::difference(run.model, run.references[from].q, run.references[k].q, displacement);
    if (largest(displacement) <= kStill) {  // still there, or back again without a rest between
      from = k;
      continue;
    }
    Reach reach{.begin = from, .arrival = k, .end = k, .joints = {}};
    std::vector<std::vector<double>> beyond(joints.size());
    const Eigen::VectorXd& target = run.references[k].q;
    for (; reach.end < rests.size() && rests[reach.end]; ++reach.end) {
      rbd::difference(run.model, target, run.references[reach.end].q, e);
      if (largest(e) > kStill) break;  // it jumped: the next reach
      rbd::difference(run.model, target, run.states[reach.end].q, e);
      for (size_t j = 0; j < joints.size(); ++j) beyond[j].push_back(e[joints[j].iv]);
    }
    from = k = --reach.end;
    for (size_t j = 0; j < joints.size(); ++j)
      reach.joints.push_back(joint_of_reach(run, reach, displacement[joints[j].iv], beyond[j]));
    all.push_back(std::move(reach));
  }
  return all;
}

void add_reach_metrics(json& out, const Run& run) {
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  const std::vector<Reach> all = reaches(run);
  out["reach_count"] = all.size();
  put_reach_stats(out, all, -1);
  for (const Reach& reach : all) out["reaches"].push_back(reach_json(run, reach, joints));
  for (size_t j = 0; j < joints.size(); ++j) put_reach_stats(out["joints"][j], all, static_cast<int>(j));
}

}  // namespace lab
