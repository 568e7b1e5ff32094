// Splines: what defines them (points met, smooth at every knot, as wanted at the ends, of the right degree) is checked one
// by one; splines through known curves give them back; extremes against dense sampling.
#include "procs/planner/spline.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace lab::planner {
namespace {

using Eigen::VectorXd;

struct Point {
  VectorXd q, v, a;
};
/// On one piece, even outside of it.
Point on(const Spline::Piece& piece, double u) {
  Point p{VectorXd(piece.c.rows()), VectorXd(piece.c.rows()), VectorXd(piece.c.rows())};
  Spline{{piece}}.at(u, p.q, p.v, p.a);
  return p;
}
Point on(const Spline& spline, double u) {
  Point p = on(spline.pieces[0], 0);
  spline.at(u, p.q, p.v, p.a);
  return p;
}

struct Given {
  std::vector<double> knots{0};
  std::vector<VectorXd> points;
};
Given some(unsigned seed, int pieces, bool even) {
  std::mt19937 engine(seed);
  const auto random = [&](double low, double high) {
    return low + (high - low) * static_cast<double>(engine()) / 4294967296.0;
  };
  Given g;
  for (int k = 0; k <= pieces; ++k) {
    if (k > 0) g.knots.push_back(g.knots.back() + (even ? 0.3 : random(0.1, 0.8)));
    g.points.emplace_back(3);
    for (double& x : g.points.back()) x = random(-1, 1);
  }
  return g;
}

TEST(Spline, MeetsItsPointsSmoothly) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    const bool rest = seed % 2 == 0;
    const int pieces = rest ? 1 + static_cast<int>(seed / 2) % 9 : 4 + static_cast<int>(seed / 2) % 9;
    SCOPED_TRACE("seed " + std::to_string(seed));
    const Given g = some(seed, pieces, !rest);
    const Spline s = through(g.knots, g.points, rest ? Ends::Rest : Ends::Free);
    ASSERT_EQ(s.pieces.size(), static_cast<size_t>(pieces));
    // numbers up to 2 d / h^2 = 200 cancel, a few of them: 1e-12 is 20 of their roundings
    for (int k = 0; k < pieces; ++k) {
      const Point first = on(s.pieces[k], g.knots[k]), last = on(s.pieces[k], g.knots[k + 1]);
      EXPECT_LE((first.q - g.points[k]).norm(), 1e-14);
      EXPECT_LE((last.q - g.points[k + 1]).norm(), 1e-14);
      const bool end_piece = rest && (k == 0 || k + 1 == pieces);
      EXPECT_TRUE(pieces == 1 || s.pieces[k].c.col(5).isZero(0)) << "at most quartic";
      EXPECT_TRUE(end_piece || s.pieces[k].c.col(4).isZero(0)) << "cubic";
      if (k == 0) continue;
      const Point before = on(s.pieces[k - 1], g.knots[k]);
      EXPECT_LE((first.v - before.v).norm(), 1e-12);
      EXPECT_LE((first.a - before.a).norm(), 1e-11);
    }
    if (!rest) continue;
    const Point first = on(s, 0), last = on(s, s.end());
    EXPECT_EQ(first.v.norm(), 0);
    EXPECT_EQ(first.a.norm(), 0);
    EXPECT_LE(last.v.norm(), 1e-12);
    EXPECT_LE(last.a.norm(), 1e-11);
  }
}

TEST(Spline, GivesCubicsBackAndFourthOrderForTheRest) {
  const auto cubic = [](double u) { return 1 - 2 * u + 0.5 * u * u + 3 * u * u * u; };
  const auto worst = [](int pieces, auto f) {
    Given g;
    for (int k = 0; k <= pieces; ++k) {
      if (k > 0) g.knots.push_back(static_cast<double>(k) / pieces);
      g.points.push_back(VectorXd::Constant(1, f(g.knots.back())));
    }
    const Spline s = through(g.knots, g.points, Ends::Free);
    double most = 0;
    for (int k = 0; k <= 1000; ++k) most = std::max(most, std::abs(on(s, k / 1000.0).q[0] - f(k / 1000.0)));
    return most;
  };
  for (int pieces : {4, 5, 16}) EXPECT_LE(worst(pieces, cubic), 1e-14);
  const auto wave = [](double u) { return std::sin(6 * u + 0.4); };
  const double coarse = worst(32, wave), fine = worst(64, wave);
  // h^4 / 384 of the fourth derivative, 6^4, and beside the ends 4 h / 27 (the largest that a slope of 1 makes of a cubic
  // piece) of what the five points miss of the slope: h^4 / 5 of the fifth derivative, 6^5
  const double h = 1.0 / 64;
  EXPECT_LE(fine, std::pow(h, 4) * (1296 / 384.0 + 4 * h / 27 * 7776 / 5)) << fine;
  EXPECT_GE(coarse / fine, 15) << "of fourth order";
}

TEST(Spline, ExtremesAreExact) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Given g = some(seed, 1 + static_cast<int>(seed) % 5, false);
    const Spline s = through(g.knots, g.points, Ends::Rest);
    for (int order = 0; order < 3; ++order) {
      VectorXd most = VectorXd::Zero(3);
      for (const Spline::Piece& piece : s.pieces)
        for (Eigen::Index i = 0; i < 3; ++i) {
          SCOPED_TRACE(std::to_string(seed) + " " + std::to_string(order));
          const Extremes e = extremes(piece, i, order);
          const auto value = [&](double u) {
            return order == 0 ? on(piece, u).q[i] : order == 1 ? on(piece, u).v[i] : on(piece, u).a[i];
          };
          double low = 1e9, high = -1e9;
          for (int k = 0; k <= 2000; ++k) {
            const double y = value(piece.start + piece.length * k / 2000);
            low = std::min(low, y);
            high = std::max(high, y);
          }
          const double scale = std::pow(piece.length, -order);
          EXPECT_NEAR(value(e.low_at), e.low, 1e-12 * scale);
          EXPECT_NEAR(value(e.high_at), e.high, 1e-12 * scale);
          EXPECT_LE(e.low, low + 1e-12 * scale);
          EXPECT_GE(e.high, high - 1e-12 * scale);
          // between samples a polynomial with derivatives up to 400 rises by 400 (1 / 4000)^2 / 2 at most
          EXPECT_NEAR(e.low, low, 1.3e-5 * scale);
          EXPECT_NEAR(e.high, high, 1.3e-5 * scale);
          most[i] = std::max({most[i], -e.low, e.high});
        }
      EXPECT_EQ(largest(s, order), most);
    }
  }
}

TEST(Spline, StretchedItIsTheSameCurve) {
  const Given g = some(5, 4, false);
  Spline s = through(g.knots, g.points, Ends::Rest), slow = s;
  slow.stretch(3);
  for (double u = 0; u < s.end(); u += 0.05) {
    const Point a = on(s, u), b = on(slow, 3 * u);
    EXPECT_LE((a.q - b.q).norm(), 1e-13);
    EXPECT_LE((a.v - 3 * b.v).norm(), 1e-12);
    EXPECT_LE((a.a - 9 * b.a).norm(), 1e-11);
  }
}

TEST(Spline, BeyondItsEndsItIsItsEndPieces) {
  const Given g = some(7, 3, false);
  const Spline s = through(g.knots, g.points, Ends::Rest);
  EXPECT_EQ(on(s, -0.1).q, on(s.pieces.front(), -0.1).q);
  EXPECT_EQ(on(s, s.end() + 0.1).q, on(s.pieces.back(), s.end() + 0.1).q);
}

TEST(Spline, OutsideNamesTheFirstPlace) {
  // 0, 1, 0 at rest at both ends: the top is at 1
  const std::vector<VectorXd> points{VectorXd::Zero(2), VectorXd::Ones(2), VectorXd::Zero(2)};
  const Spline s = through({0, 1, 2}, points, Ends::Rest);
  const VectorXd low = VectorXd::Constant(2, -0.1);
  VectorXd high = VectorXd::Ones(2);
  EXPECT_EQ(outside(s, low, high).joint, -1);
  high[1] = 0.9;
  const Outside found = outside(s, low, high);
  EXPECT_EQ(found.joint, 1);
  EXPECT_EQ(found.piece, 0u);
  EXPECT_NEAR(found.value, 1, 1e-12);
  EXPECT_EQ(found.limit, 0.9);
  EXPECT_NEAR(found.at, 1, 1e-6);
}

// Beyond a limit by exactly 1e-9, which may be rounding, is inside; by the next number it is not.
TEST(Spline, OutsideForgivesRoundingOnly) {
  const VectorXd low = VectorXd::Constant(1, -0.5), high = VectorXd::Constant(1, 0.5);
  const auto rests_inside = [&](double q) {
    const VectorXd point = VectorXd::Constant(1, q);
    return outside(through({0, 1}, {point, point}, Ends::Rest), low, high).joint < 0;
  };
  for (const double edge : {0.5 + 1e-9, -0.5 - 1e-9}) {
    EXPECT_TRUE(rests_inside(edge)) << edge;
    EXPECT_FALSE(rests_inside(std::nextafter(edge, 2 * edge))) << edge;
  }
}

}  // namespace
}  // namespace lab::planner
