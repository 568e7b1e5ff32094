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
  const size_t n = run.steps.size();
  std::vector<bool> out(n);
  Eigen::VectorXd moved(run.model.nv);
  StepReader steps(run.steps), next_steps(run.steps);
  bool same_as_before = false;  // the place as at the step before
  for (size_t k = 0; k < n; ++k) {
    const Reference& reference = steps.at(k).reference;
    bool same_as_next = false;
    if (k + 1 < n) {
      rbd::difference(run.model, reference.q, next_steps.at(k + 1).reference.q, moved);
      same_as_next = largest(moved) <= kStill;
    }
    if (largest(reference.v) <= kStill)
      out[k] = k + 1 == n || same_as_next || (k > 0 && out[k - 1] && same_as_before);
    same_as_before = same_as_next;
  }
  return out;
}

/// Follows one joint from arrival to the end of a rest.
class JointAtRest {
 public:
  JointAtRest(double displacement, double band) : band_(band), moved_(std::abs(displacement) > band) {
    out_.displacement = displacement;
    out_.overshoot = moved_ ? 0 : NAN;
  }

  /// `beyond`: q - target.
  void add(int64_t step, double beyond) {
    if (std::abs(beyond) > band_)
      inside_since_ = -1;
    else if (inside_since_ < 0)
      inside_since_ = step;
    if (moved_) out_.overshoot = std::max(out_.overshoot, out_.displacement > 0 ? beyond : -beyond);
  }
  /// The same of the last tenth once more.
  void add_late(double beyond) { late_sum_ += beyond; }

  Reach::Joint figures(int64_t arrival_step, double dt, size_t late_steps) {
    out_.settling = inside_since_ < 0 ? NAN : static_cast<double>(inside_since_ - arrival_step) * dt;
    out_.overshoot_share = out_.overshoot / std::abs(out_.displacement);
    out_.steady_error = std::abs(late_sum_ / static_cast<double>(late_steps));
    return out_;
  }

 private:
  double band_;
  bool moved_;
  Reach::Joint out_;
  int64_t inside_since_ = -1;  ///< step; -1 = it is outside
  double late_sum_ = 0;
};

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
  StepReader steps(run.steps);
  const auto time = [&](size_t k) { return static_cast<double>(steps.at(k).state.step) * run.dt; };
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
  if (run.steps.empty()) return all;
  const std::vector<TrackedJoint> joints = joints_of(run.model);
  const std::vector<bool> rests = resting(run);
  Eigen::VectorXd displacement(run.model.nv), e(run.model.nv);
  StepReader steps(run.steps);
  size_t from = 0;  // the last step at the place before
  Eigen::VectorXd place = steps.at(0).reference.q;
  for (size_t k = 1; k < rests.size(); ++k) {
    if (!rests[k]) continue;
    const Eigen::VectorXd target = steps.at(k).reference.q;
    rbd::difference(run.model, place, target, displacement);
    if (largest(displacement) <= kStill) {  // still there, or back again without a rest between
      from = k;
      place = target;
      continue;
    }
    Reach reach{.begin = from, .arrival = k, .end = k, .joints = {}};
    const int64_t arrival_step = steps.at(k).state.step;
    std::vector<JointAtRest> at_rest;
    for (const TrackedJoint& joint : joints) at_rest.emplace_back(displacement[joint.iv], run.band);
    for (; reach.end < rests.size() && rests[reach.end]; ++reach.end) {
      const RunStep& step = steps.at(reach.end);
      rbd::difference(run.model, target, step.reference.q, e);
      if (largest(e) > kStill) break;  // it jumped: the next reach
      rbd::difference(run.model, target, step.state.q, e);
      for (size_t j = 0; j < joints.size(); ++j) at_rest[j].add(step.state.step, e[joints[j].iv]);
    }
    const size_t late = std::max<size_t>(1, (reach.end - k) / 10);
    for (size_t i = reach.end - late; i < reach.end; ++i) {
      rbd::difference(run.model, target, steps.at(i).state.q, e);
      for (size_t j = 0; j < joints.size(); ++j) at_rest[j].add_late(e[joints[j].iv]);
    }
    from = k = --reach.end;
    place = steps.at(k).reference.q;
    for (JointAtRest& joint : at_rest) reach.joints.push_back(joint.figures(arrival_step, run.dt, late));
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
