#pragma once
#include <Eigen/Core>
#include <vector>

/// Curves through points, made of polynomials. Value, slope and second derivative are continuous from piece to piece.
namespace lab::planner {

struct Spline {
  struct Piece {
    double start, length;  ///< of the parameter u
    Eigen::Matrix<double, Eigen::Dynamic, 6>
        c;  ///< a row per joint: c0 + c1 x + .. + c5 x^5, x = (u - start) / length
  };
  std::vector<Piece> pieces;

  double end() const { return pieces.back().start + pieces.back().length; }
  /// Value and the first two derivatives by u, 0 <= u <= end(). The vectors have their sizes.
  void at(double u, Eigen::VectorXd& q, Eigen::VectorXd& slope, Eigen::VectorXd& bend) const;
  /// The same curve, `factor` times as slow.
  void stretch(double factor);
};

enum class Ends {
  /// Slope and second derivative 0 at both ends: rest goes over into motion without a jump of the acceleration. The first
  /// and the last piece have degree 4, those between degree 3 (the "4-3-4 trajectory" of the textbooks, for any number
  /// of points); a single piece is the quintic.
  Rest,
  /// The slope at either end is that of the polynomial through the five points nearest to it. Needs five points, equally
  /// far apart. The error between the points of a smooth curve is O(length^4), at the ends too.
  Free,
};

/// The curve with value points[k] at u = knots[k]; knots rise, knots[0] = 0.
Spline through(const std::vector<double>& knots, const std::vector<Eigen::VectorXd>& points, Ends);

/// Smallest and largest value, and where (u). Exact: at the ends or where the derivative is 0.
struct Extremes {
  double low, high, low_at, high_at;
};
/// Of the derivative by u of an order 0 (the value itself), 1 or 2, of one joint on one piece.
Extremes extremes(const Spline::Piece&, Eigen::Index joint, int order);

/// Largest size of each joint's derivative of this order along the whole curve.
Eigen::VectorXd largest(const Spline&, int order);

/// The first place where the curve is outside of low .. high by more than rounding.
struct Outside {
  size_t piece = 0;
  Eigen::Index joint = -1;  ///< -1: there is none
  double value = 0, limit = 0, at = 0;
};
Outside outside(const Spline&, const Eigen::VectorXd& low, const Eigen::VectorXd& high);

}  // namespace lab::planner
