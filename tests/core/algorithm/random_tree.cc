#include "tests/core/algorithm/random_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rbd::testing {

Model randomTree(unsigned seed, int n, bool free_root, Order order) {
  Random random(seed);
  Model model;
  model.name = "tree" + std::to_string(seed);
  const Eigen::Vector3d axes[] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}, random.vec3(), random.vec3()};
  JointIndex last = 0;
  for (int i = 1; i <= n; ++i) {
    JointIndex parent = i == 1 ? 0 : random.below(i);
    if (free_root && i > 1 && parent == 0) parent = 1;
    if (order == Order::DepthFirst) {
      // climb a random number of steps from the joint added last
      parent = last;
      for (int up = random.below(3); up > 0 && parent > (free_root ? 1 : 0); --up)
        parent = model.parents[parent];
    }
    const Eigen::Vector3d axis = axes[random.below(6)];
    const std::string name = "joint" + std::to_string(i);
    const int kind = random.below(8);
    if ((free_root && i == 1) || kind == 7) {
      last = model.addJoint(parent, JointModelFreeFlyer(), random.pose(), name);
    } else if (kind < 4) {
      last = model.addJoint(parent, JointModelRevoluteUnaligned(axis), random.pose(), name);
    } else if (kind == 4) {
      last = model.addJoint(parent, JointModelContinuous(axis), random.pose(), name);
    } else {
      last = model.addJoint(parent, JointModelPrismaticUnaligned(axis), random.pose(), name);
    }
    model.appendBodyToJoint(last, random.inertia(), random.pose());
    model.addFrame(Frame("tool" + std::to_string(i), last, random.pose(), OP_FRAME));
  }
  model.appendBodyToJoint(0, random.inertia());  // bolted to the ground: no algorithm may see it
  for (double& x : model.armature) x = random.in(0, 0.2);
  return model;
}

State randomState(const Model& model, unsigned seed) {
  Random random(seed + 1000);
  return {randomConfiguration(model, random.engine), random.vec(model.nv), random.vec(model.nv),
          random.vec(model.nv, 5)};
}

double distance(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  if (a.rows() != b.rows() || a.cols() != b.cols()) return std::numeric_limits<double>::infinity();
  double worst = 0, size = 1;
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    const double error = std::abs(a.data()[i] - b.data()[i]);
    if (!(error <= worst)) worst = error;
    if (worst != worst) return worst;
    size = std::max(size, std::abs(b.data()[i]));
  }
  return worst / size;
}

Eigen::MatrixXd times(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return a * b; }

double condition(const Eigen::MatrixXd& m, const Eigen::MatrixXd& inverse) {
  return m.norm() * inverse.norm();
}

}  // namespace rbd::testing
