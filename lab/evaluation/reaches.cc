#include "lab/evaluation/reaches.h"

#include <rbd/rbd.h>

#include <cmath>

#include "lab/evaluation/tracking.h"

namespace lab {
namespace {

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

Reach::Joint judge(const Run& run, const Reach& reach, double way, const std::vector<double>& beyond) {
  // beyond: by step from arrival to end, how far the joint is past the target (q - target)
  Reach::Joint out;
  out.way = way;
  size_t inside_since = beyond.size();  // of the last stretch
  for (size_t i = beyond.size(); i-- > 0 && std::abs(beyond[i]) <= run.band;) inside_since = i;
  out.settling = inside_since == beyond.size()
                     ? NAN
                     : static_cast<double>(run.states[reach.arrival + inside_since].step -
                                           run.states[reach.arrival].step) *
                           run.dt;
  if (std::abs(way) > run.band) {
    for (double b : beyond) out.overshoot = std::max(out.overshoot, way > 0 ? b : -b);
    out.overshoot_share = out.overshoot / std::abs(way);
  } else {
    out.overshoot = out.overshoot_share = NAN;
  }
  const size_t last = std::max<size_t>(1, beyond.size() / 10);
  double sum = 0;
  for (size_t i = beyond.size() - last; i < beyond.size(); ++i) sum += beyond[i];
  out.steady_error = std::abs(sum / static_cast<double>(last));
  return out;
}

}  // namespace

std::vector<Reach> reaches(const Run& run) {
  std::vector<Reach> all;
  if (run.states.empty()) return all;
  const std::vector<JointFigures> joints = joints_of(run.model);
  const std::vector<bool> rests = resting(run);
  Eigen::VectorXd way(run.model.nv), e(run.model.nv);
  size_t from = 0;  // the last step at the place before
  for (size_t k = 1; k < rests.size(); ++k) {
    if (!rests[k]) continue;
    rbd::difference(run.model, run.references[from].q, run.references[k].q, way);
    if (largest(way) <= kStill) {  // still there, or back again without a rest between
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
      reach.joints.push_back(judge(run, reach, way[joints[j].iv], beyond[j]));
    all.push_back(std::move(reach));
  }
  return all;
}

ReachFigures over_reaches(const std::vector<Reach>& all, int joint) {
  ReachFigures out{0, 0, NAN, NAN, 0};
  const auto larger = [](double a, double b) {
    return std::isnan(a) || b > a ? b : a;
  };  // a number, if there is one
  for (const Reach& reach : all) {
    double slowest = 0;  // NaN: one does not settle
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

}  // namespace lab
