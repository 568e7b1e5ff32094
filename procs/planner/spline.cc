#include "procs/planner/spline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lab::planner {
namespace {

using Polynomial = std::array<double, 6>;  // c0 + c1 x + .. + c5 x^5

double value(const Polynomial& c, double x) { return evaluate(c, x).value; }

Polynomial derivative(const Polynomial& c) { return {c[1], 2 * c[2], 3 * c[3], 4 * c[4], 5 * c[5], 0}; }

/// Where 0 < x < 1 and the value changes its sign. Between neighbouring turning points a polynomial is monotone, so that
/// halving finds the one root there may be.
std::vector<double> roots(const Polynomial& c) {
  std::vector<double> found, bounds{0};
  if (std::all_of(c.begin() + 1, c.end(), [](double ci) { return ci == 0; })) return found;
  for (double x : roots(derivative(c))) bounds.push_back(x);
  bounds.push_back(1);
  for (size_t i = 0; i + 1 < bounds.size(); ++i) {
    double low = bounds[i], high = bounds[i + 1];
    const bool rises = value(c, low) < 0;
    if (rises == (value(c, high) < 0)) continue;
    for (int n = 0; n < 60; ++n) {
      const double middle = (low + high) / 2;
      ((value(c, middle) < 0) == rises ? low : high) = middle;
    }
    found.push_back((low + high) / 2);
  }
  return found;
}

/// One row of the equations for the slopes at the knots between: second derivative at the end of the piece before =
/// that at the start of the piece after.
struct Row {
  double before = 0, own = 0, after = 0;
  Eigen::VectorXd right;
};

/// The quintic with value `from`, slope a and second derivative a2 (by x) at x = 0; from + d, b and b2 at x = 1.
template <class Row>
void set_quintic(Row&& c, double from, double d, double a, double a2, double b, double b2) {
  c << from, a, a2 / 2, 10 * d - 6 * a - 4 * b - 1.5 * a2 + 0.5 * b2, -15 * d + 8 * a + 7 * b + 1.5 * a2 - b2,
      6 * d - 3 * a - 3 * b - 0.5 * a2 + 0.5 * b2;
}

/// From rest at x = 0, or to rest at x = 1, or neither; d from value to value, slopes a and b (by x) at the ends that do
/// not rest.
void set_piece(Spline::Piece& piece, Eigen::Index i, double from, double d, double a, double b, bool starts,
               bool ends) {
  auto c = piece.c.row(i);
  if (starts && ends)
    set_quintic(c, from, d, 0, 0, 0, 0);
  else if (starts)
    c << from, 0, 0, 4 * d - b, b - 3 * d, 0;
  else if (ends)
    c << from, a, 6 * d - 3 * a, 3 * a - 8 * d, 3 * d - a, 0;
  else
    c << from, a, 3 * d - 2 * a - b, a + b - 2 * d, 0, 0;
}

/// Slope at p[0] of the polynomial through five points that are h apart.
Eigen::VectorXd end_slope(const Eigen::VectorXd* p, double h, int step) {
  return (-25 * p[0] + 48 * p[step] - 36 * p[2 * step] + 16 * p[3 * step] - 3 * p[4 * step]) /
         (12 * h * step);
}

}  // namespace

void Spline::Piece::at(double u, Eigen::VectorXd& q, Eigen::VectorXd& slope, Eigen::VectorXd& bend) const {
  const double x = (u - start) / length;
  for (Eigen::Index i = 0; i < c.rows(); ++i) {
    const Derivatives p = evaluate(c.row(i), x);
    q[i] = p.value;
    slope[i] = p.first / length;
    bend[i] = p.second / (length * length);
  }
}

void Spline::at(double u, Eigen::VectorXd& q, Eigen::VectorXd& slope, Eigen::VectorXd& bend) const {
  const auto after = std::upper_bound(pieces.begin() + 1, pieces.end(), u,
                                      [](double at, const Piece& p) { return at < p.start; });
  (after - 1)->at(u, q, slope, bend);
}

void Spline::stretch(double factor) {
  for (Piece& piece : pieces) {
    piece.start *= factor;
    piece.length *= factor;
  }
}

Spline::Piece quintic(double start, double length, const Reference& from, const Reference& to) {
  Spline::Piece piece{start, length, {}};
  piece.c.resize(from.q.size(), 6);
  for (Eigen::Index i = 0; i < from.q.size(); ++i)
    set_quintic(piece.c.row(i), from.q[i], to.q[i] - from.q[i], from.v[i] * length,
                from.a[i] * length * length, to.v[i] * length, to.a[i] * length * length);
  return piece;
}

Spline::Piece quintic(double start, double length, const Eigen::VectorXd& from, const Eigen::VectorXd& to) {
  Spline::Piece piece{start, length, {}};
  piece.c.resize(from.size(), 6);
  for (Eigen::Index i = 0; i < from.size(); ++i)
    set_quintic(piece.c.row(i), from[i], to[i] - from[i], 0, 0, 0, 0);
  return piece;
}

Progress quintic_progress(double t, double T) {
  constexpr std::array<double, 6> kRestToRest{0, 0, 0, 10, -15, 6};
  const Derivatives p = evaluate(kRestToRest, t / T);
  return {p.value, p.first / T, p.second / (T * T)};
}

Spline through(const std::vector<double>& knots, const std::vector<Eigen::VectorXd>& points, Ends ends) {
  const size_t n = points.size() - 1;  // pieces
  const Eigen::Index size = points[0].size();
  const bool rest = ends == Ends::Rest;
  std::vector<Eigen::VectorXd> slope(n + 1, Eigen::VectorXd::Zero(size));
  if (!rest) {
    slope[0] = end_slope(&points[0], knots[1] - knots[0], 1);
    slope[n] = end_slope(&points[n], knots[n] - knots[n - 1], -1);
  }
  // With distance d and length h the second derivative of a cubic piece is (6 d / h - 4 v - 2 w) / h where its slope is v, and
  // the negative where it is w, v and w exchanged; of a piece to rest (12 d / h - 6 v) / h. Thomas' algorithm, downwards ..
  std::vector<Row> rows(n);
  for (size_t k = 1; k < n; ++k) {
    Row& row = rows[k];
    const double h = knots[k] - knots[k - 1], g = knots[k + 1] - knots[k];
    const bool starts = rest && k == 1, stops = rest && k + 1 == n;
    row.before = starts ? 0 : 2 / h;
    row.after = stops ? 0 : 2 / g;
    row.own = (starts ? 6 : 4) / h + (stops ? 6 : 4) / g;
    row.right = (starts ? 12 : 6) / (h * h) * (points[k] - points[k - 1]) +
                (stops ? 12 : 6) / (g * g) * (points[k + 1] - points[k]);
    if (k == 1) row.right -= row.before * slope[0];
    if (k + 1 == n) row.right -= row.after * slope[n];
    if (k == 1) continue;
    const double share = row.before / rows[k - 1].own;
    row.own -= share * rows[k - 1].after;
    row.right -= share * rows[k - 1].right;
  }
  // .. and up again
  for (size_t k = n - 1; k >= 1 && k < n; --k) {
    slope[k] = rows[k].right / rows[k].own;
    if (k + 1 < n) slope[k] -= rows[k].after / rows[k].own * slope[k + 1];
  }
  Spline spline;
  for (size_t k = 0; k < n; ++k) {
    Spline::Piece& piece = spline.pieces.emplace_back();
    const double h = knots[k + 1] - knots[k];
    piece.start = knots[k];
    piece.length = h;
    piece.c.resize(size, 6);
    for (Eigen::Index i = 0; i < size; ++i)
      set_piece(piece, i, points[k][i], points[k + 1][i] - points[k][i], h * slope[k][i], h * slope[k + 1][i],
                rest && k == 0, rest && k + 1 == n);
  }
  return spline;
}

Extremes extremes(const Spline::Piece& piece, Eigen::Index joint, int order) {
  Polynomial c;
  for (int k = 0; k < 6; ++k) c[k] = piece.c(joint, k);
  for (int k = 0; k < order; ++k) c = derivative(c);
  const double scale = std::pow(piece.length, -order);
  Extremes out{value(c, 0), value(c, 0), 0, 0};
  std::vector<double> candidates = roots(derivative(c));
  candidates.push_back(1);
  for (double x : candidates) {
    const double y = value(c, x);
    if (y < out.low) {
      out.low = y;
      out.low_at = x;
    }
    if (y > out.high) {
      out.high = y;
      out.high_at = x;
    }
  }
  return {out.low * scale, out.high * scale, piece.start + out.low_at * piece.length,
          piece.start + out.high_at * piece.length};
}

Eigen::VectorXd largest(const Spline& spline, int order) {
  Eigen::VectorXd out = Eigen::VectorXd::Zero(spline.pieces[0].c.rows());
  for (const Spline::Piece& piece : spline.pieces)
    for (Eigen::Index i = 0; i < out.size(); ++i) {
      const Extremes found = extremes(piece, i, order);
      out[i] = std::max({out[i], -found.low, found.high});
    }
  return out;
}

Outside outside(const Spline& spline, const Eigen::VectorXd& low, const Eigen::VectorXd& high) {
  constexpr double kRounding = 1e-9;
  for (size_t k = 0; k < spline.pieces.size(); ++k)
    for (Eigen::Index i = 0; i < low.size(); ++i) {
      const Extremes found = extremes(spline.pieces[k], i, 0);
      if (found.low < low[i] - kRounding) return {k, i, found.low, low[i], found.low_at};
      if (found.high > high[i] + kRounding) return {k, i, found.high, high[i], found.high_at};
    }
  return {};
}

}  // namespace lab::planner
