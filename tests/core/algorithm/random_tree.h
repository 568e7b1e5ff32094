// Random robots and states for tests. Fixed seeds: every run sees the same ones.
#pragma once

#include <rbd/rbd.h>

#include <random>
#include <string>

namespace rbd::testing {

inline constexpr double kEps = 2.220446049250313e-16;

class Random {
 public:
  explicit Random(unsigned seed) : engine(seed) {}
  double in(double a, double b) { return a + (b - a) * static_cast<double>(engine() >> 11) * 0x1p-53; }
  int below(int n) { return static_cast<int>(engine() % static_cast<unsigned>(n)); }
  Eigen::Vector3d vec3(double size = 1) { return {in(-size, size), in(-size, size), in(-size, size)}; }
  Eigen::VectorXd vec(Eigen::Index n, double size = 1) {
    Eigen::VectorXd x(n);
    for (double& y : x) y = in(-size, size);
    return x;
  }
  SE3 pose() { return SE3(exp3(vec3(3)), vec3()); }
  // A body that can exist: mass points, spread.
  Inertia inertia() {
    Inertia sum;
    for (int k = 0; k < 5; ++k) {
      sum += Inertia(in(0.1, 1), vec3(0.3), 1e-3 * Eigen::Matrix3d::Identity());
    }
    return sum;
  }
  Motion motion() { return Motion(vec3(), vec3()); }
  Force force() { return Force(vec3(), vec3()); }
  std::mt19937_64 engine;
};

enum class Order { DepthFirst, Any };

// A tree of `n` joints of every kind; the root is a free-flyer when asked. One seed in three has mimic
// joints.
Model randomTree(unsigned seed, int n, bool free_root, Order order = Order::Any);

struct State {
  Eigen::VectorXd q, v, a, tau;
};

State randomState(const Model& model, unsigned seed);

// Largest entry of |a - b| over max(1, largest entry of |b|). NaN if either has one.
double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// Matrix products, compiled once: Eigen's take seconds in every file that spells them out.
Eigen::MatrixXd times(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

// An upper bound of the condition number of a matrix and its inverse: the product of their Frobenius norms.
double condition(const Eigen::MatrixXd& m, const Eigen::MatrixXd& inverse);

}  // namespace rbd::testing
