// Curves through points, made of polynomials. Value, slope and second derivative are continuous from piece to piece.
// All motions except cubics and sinusoids are made of these: quintics, waypoints, paths, detours.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "lab/signals/signals.h"

namespace lab::planner {

/// Value and first two derivatives by x of c[0] + c[1] x + .. + c[5] x^5.
struct Derivatives {
  double value, first, second;
};
template <class Coefficients>
Derivatives evaluate(const Coefficients& c, double x) {
  return {c[0] + x * (c[1] + x * (c[2] + x * (c[3] + x * (c[4] + x * c[5])))),
          c[1] + x * (2 * c[2] + x * (3 * c[3] + x * (4 * c[4] + x * 5 * c[5]))),
          2 * c[2] + x * (6 * c[3] + x * (12 * c[4] + x * 20 * c[5]))};
}

struct Spline {
  struct Piece {
    double start = 0, length = 0;  ///< of the parameter u
    /// A row per joint: c0 + c1 x + .. + c5 x^5, x = (u - start) / length.
    Eigen::Matrix<double, Eigen::Dynamic, 6> c;

    double end() const { return start + length; }
    /// Value and the first two derivatives by u. The vectors must have their sizes already.
    void at(double u, Eigen::VectorXd& q, Eigen::VectorXd& slope, Eigen::VectorXd& bend) const;
  };
  std::vector<Piece> pieces;

  double end() const { return pieces.back().end(); }
  /// The same for the whole curve, 0 <= u <= end().
  void at(double u, Eigen::VectorXd& q, Eigen::VectorXd& slope, Eigen::VectorXd& bend) const;
  /// Slows the curve down: all lengths in u times `factor`.
  void stretch(double factor);
};

/// The quintic from one q, v, a to another within `length` (s).
Spline::Piece quintic(double start, double length, const Reference& from, const Reference& to);
/// The same from rest to rest.
Spline::Piece quintic(double start, double length, const Eigen::VectorXd& from, const Eigen::VectorXd& to);

/// The quintic from rest at 0 to rest at 1: s = 10 x^3 - 15 x^4 + 6 x^5, x = t / T.
struct Progress {
  double s, rate, acceleration;  ///< s and its time derivatives
};
Progress quintic_progress(double t, double T);
inline constexpr double kQuinticSpeed = 1.875;  // its peak, in units of distance / T
inline constexpr double kQuinticAcceleration =
    5.773502691896258;  // its peak, in units of distance / T^2: 10 / sqrt(3)

enum class Ends {
  /// Slope and second derivative 0 at both ends: the acceleration is continuous from and to rest. The first
  /// and the last piece have degree 4, those between degree 3 (the "4-3-4 trajectory" of the textbooks, for any number
  /// of points); a single piece is the quintic.
  Rest,
  /// The slope at either end is that of the polynomial through the five points nearest to it. Needs five points, equally
  /// spaced. The error between the points of a smooth curve is O(length^4), at the ends too.
  Free,
};

/// The curve with value points[k] at u = knots[k]; knots increase, knots[0] = 0.
Spline through(const std::vector<double>& knots, const std::vector<Eigen::VectorXd>& points, Ends);

/// Smallest and largest value, and where (u). Exact: at the ends or where the derivative is 0.
struct Extremes {
  double low, high, low_at, high_at;
};
/// Of the derivative by u of an order 0 (the value itself), 1 or 2, of one joint on one piece.
Extremes extremes(const Spline::Piece&, Eigen::Index joint, int order);

/// Largest absolute value of each joint's derivative of this order along the whole curve.
Eigen::VectorXd largest(const Spline&, int order);

/// The first point at which the curve leaves low .. high by more than rounding.
struct Outside {
  size_t piece = 0;
  Eigen::Index joint = -1;  ///< -1: there is none
  double value = 0, limit = 0, at = 0;
};
Outside outside(const Spline&, const Eigen::VectorXd& low, const Eigen::VectorXd& high);

}  // namespace lab::planner
