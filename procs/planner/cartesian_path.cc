#include "procs/planner/cartesian_path.h"

#include <rbd/algorithm/inverse_kinematics.h>
#include <rbd/spatial/so3.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/util/number.h"
#include "lab/experiment/cartesian.h"
#include "lab/experiment/joints.h"
#include "procs/planner/spline.h"

namespace lab::planner {
namespace {

constexpr int kMinPieces = 16, kMaxPieces = 1024;  // of a line, or per turn

struct Curve {
  const char* name;
  const char* key;                            ///< of the experiment: where it leads
  std::function<Eigen::Vector3d(double)> at;  ///< m, world, at a fraction 0..1 of the path
  double turns = 1;
};

std::string text(const Eigen::Vector3d& p) {
  return "(" + rounded(p[0]) + ", " + rounded(p[1]) + ", " + rounded(p[2]) + ")";
}

Eigen::Vector3d vector(const std::array<double, 3>& x) { return {x[0], x[1], x[2]}; }

/// Pose of the frame at q0.
rbd::SE3 start(const Experiment& e, const Config& config) {
  const rbd::Model& model = config.model;
  if (e.planner.frame.empty())
    fail(e, "planner.frame", std::string("is missing; a ") + config.kind->name + " is the path of a frame");
  if (const std::string fault = frame_fault(model, e.planner.frame); !fault.empty())
    fail(e, "planner.frame", fault);
  rbd::Data data(model);
  rbd::forwardKinematics(model, data, config.q0);
  return data.oMf[model.frameId(e.planner.frame)];
}

/// Follows a curve with a given number of pieces.
class Follow {
 public:
  Follow(const Experiment& e, const Config& config, const Curve& curve, const rbd::SE3& start)
      : config_(config), curve_(curve), scratch_(config.model), frame_(e.planner.frame) {
    target_ = {config.model.frameId(frame_), start, e.planner.keep_orientation};
    // well below the tolerance of the path: its second derivative feels an error at a knot times pieces^2
    options_.position_tolerance = options_.rotation_tolerance = 1e-9;
    options_.restarts = 0;  // they would lead to another stance of the arm
    options_.rest = config.q0;
  }

  /// Why not; empty if config's path is there and good.
  std::string with(int pieces, Spline& path) {
    std::vector<double> knots{0};
    std::vector<Eigen::VectorXd> points{config_.q0};
    for (int k = 1; k <= pieces; ++k) {
      const double s = static_cast<double>(k) / pieces;
      target_.pose = rbd::SE3(target_.pose.rotation(), curve_.at(s));
      Eigen::VectorXd q = points.back();
      const rbd::IkResult result = rbd::inverseKinematics(config_.model, scratch_, target_, options_, q);
      if (!result)
        return "'" + frame_ + "' cannot be " + place(s) + ": " + rbd::describe(config_.model, result);
      knots.push_back(s);
      points.push_back(q);
    }
    path = through(knots, points, Ends::Free);
    return leaves(path);
  }

 private:
  std::string place(double s) const {
    return "at " + rounded(100 * s) + " % of the " + curve_.name + ", " + text(curve_.at(s));
  }

  /// Between the knots, where the error of the spline is largest: is the frame still on its path?
  std::string leaves(const Spline& path) {
    Eigen::VectorXd q(config_.q0.size()), slope = q, bend = q;
    for (const Spline::Piece& piece : path.pieces)
      for (double x : {0.125, 0.25, 0.5, 0.75, 0.875}) {
        const double s = piece.start + x * piece.length;
        path.at(s, q, slope, bend);
        rbd::forwardKinematics(config_.model, scratch_.data, q);
        const rbd::SE3& pose = scratch_.data.oMf[target_.frame];
        const double off = (pose.translation() - curve_.at(s)).norm();
        const double turned =
            target_.rotation
                ? rbd::log3(Eigen::Matrix3d(target_.pose.rotation() * pose.rotation().transpose())).norm()
                : 0;
        if (off <= kPathTolerance && turned <= kTurnTolerance) continue;
        return "'" + frame_ + "' would be " + rounded(off) + " m" +
               (turned > kTurnTolerance ? " and " + rounded(turned) + " rad" : "") + " off " + place(s) +
               ": the joints cannot follow smoothly there (a singularity, or a joint's limit)";
      }
    return "";
  }

  const Config& config_;
  const Curve& curve_;
  rbd::IkScratch scratch_;
  rbd::IkOptions options_;
  rbd::FrameTarget target_;
  std::string frame_;
};

/// The largest speeds and accelerations when the whole path takes 1 s, by sampling: 16 times per piece, on which they are
/// nearly parabolas, misses less than 0.1 % of a peak; that much is added.
void find_peaks(const Spline& path, Eigen::VectorXd& v, Eigen::VectorXd& a) {
  const Eigen::Index n = path.pieces[0].c.rows();
  Eigen::VectorXd q(n), slope(n), bend(n);
  v.setZero(n);
  a.setZero(n);
  const int samples = 16 * static_cast<int>(path.pieces.size());
  for (int k = 0; k <= samples; ++k) {
    const Progress p = quintic_progress(static_cast<double>(k) / samples, 1);
    path.at(p.s, q, slope, bend);
    for (Eigen::Index i = 0; i < n; ++i) {
      v[i] = std::max(v[i], std::abs(slope[i] * p.rate));
      a[i] = std::max(a[i], std::abs(bend[i] * p.rate * p.rate + slope[i] * p.acceleration));
    }
  }
  v *= 1.001;
  a *= 1.001;
}

struct CartesianPath : Motion {
  CartesianPath(const Experiment& e, const Config& c, const Curve& curve, const rbd::SE3& start) {
    Follow follow(e, c, curve, start);
    const int turns = std::max(1, static_cast<int>(std::ceil(std::abs(curve.turns))));
    std::string fault = "?";
    for (int pieces = kMinPieces; pieces <= kMaxPieces && !fault.empty(); pieces *= 2)
      fault = follow.with(pieces * turns, path);
    if (!fault.empty())
      fail(e, curve.key, fault + "; start elsewhere (simulator.q0) or give the path another place");
    if (const Outside found = outside(path, c.q_min, c.q_max); found.joint >= 0)
      fail(e, curve.key,
           "joint '" + joint_at(c.model, static_cast<int>(found.joint)) + "' would be at " +
               rounded(found.value) + " at " + rounded(100 * found.at) + " % of the " + curve.name +
               "; its limit is " + number(found.limit) + "; start elsewhere (simulator.q0)");
    Eigen::VectorXd a;
    find_peaks(path, peak_speed, a);
    chosen_time = e.planner.duration == 0;
    duration = chosen_time ? shortest_time(c, peak_speed, a) : e.planner.duration;
    peak_speed /= duration;
    Eigen::VectorXd slope = c.q0, bend = c.q0;
    last = c.q0;
    path.at(1, last, slope, bend);
  }

  void at(double t, Reference& out) const override {
    if (t >= duration) return stay(last, out);
    const Progress p = quintic_progress(t, duration);
    path.at(p.s, out.q, out.v, out.a);
    for (Eigen::Index i = 0; i < out.q.size(); ++i) {
      const double slope = out.v[i];
      out.v[i] = slope * p.rate;
      out.a[i] = out.a[i] * p.rate * p.rate + slope * p.acceleration;
    }
  }
  std::optional<double> rejoin_time(double t) const override { return t; }

  Spline path;  // by the fraction of the path
  Eigen::VectorXd last;
};

}  // namespace

std::unique_ptr<Motion> make_line(const Experiment& e, const Config& config) {
  const rbd::SE3 from = start(e, config);
  if (!e.planner.to) fail(e, "planner.to", "is missing; a line needs the position where it ends, [x, y, z]");
  const Eigen::Vector3d &a = from.translation(), ab = vector(*e.planner.to) - a;
  const Curve curve{"line", "planner.to", [a, ab](double s) -> Eigen::Vector3d { return a + s * ab; }};
  return std::make_unique<CartesianPath>(e, config, curve, from);
}

std::unique_ptr<Motion> make_circle(const Experiment& e, const Config& config) {
  const rbd::SE3 from = start(e, config);
  if (!e.planner.center)
    fail(e, "planner.center", "is missing; a circle needs a point of its axis, [x, y, z]");
  const Eigen::Vector3d normal = vector(e.planner.normal);
  if (!(normal.norm() > 1e-6))
    fail(e, "planner.normal", "has length " + rounded(normal.norm()) + "; it must point somewhere");
  // only the axis matters: the circle's plane is the one through the start
  const Eigen::Vector3d axis = normal.normalized(), off = from.translation() - vector(*e.planner.center);
  const Eigen::Vector3d x = off - axis * axis.dot(off), y = axis.cross(x), middle = from.translation() - x;
  if (!(x.norm() > 1e-3))
    fail(e, "planner.center",
         "'" + e.planner.frame + "' starts at " + text(from.translation()) + ", " + rounded(x.norm()) +
             " m from the axis of its circle; move the one or the other");
  const double angle = 2 * M_PI * e.planner.turns;
  const auto at = [=](double s) -> Eigen::Vector3d {
    return middle + std::cos(s * angle) * x + std::sin(s * angle) * y;
  };
  return std::make_unique<CartesianPath>(e, config, Curve{"circle", "planner.center", at, e.planner.turns},
                                         from);
}

}  // namespace lab::planner
