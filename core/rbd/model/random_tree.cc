#include "rbd/model/random_tree.h"

#include <random>
#include <stdexcept>
#include <string>
#include <vector>

namespace rbd::buildModels {
namespace {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double in(double a, double b) { return a + (b - a) * static_cast<double>(engine_() >> 11) * 0x1p-53; }
  int below(int n) { return static_cast<int>(engine_() % static_cast<unsigned>(n)); }
  Eigen::Vector3d vec3(double size = 1) {
    const double x = in(-size, size), y = in(-size, size), z = in(-size, size);
    return {x, y, z};
  }
  SE3 pose() {
    const Eigen::Matrix3d R = exp3(vec3(3));
    return SE3(R, vec3());
  }
  // A body that can exist: mass points, spread.
  Inertia inertia() {
    Inertia sum;
    for (int k = 0; k < 5; ++k) {
      const double mass = in(0.1, 1);
      sum += Inertia(mass, vec3(0.3), 1e-3 * Eigen::Matrix3d::Identity());
    }
    return sum;
  }
  // Exact axes, which have names of their own, as often as any others.
  Eigen::Vector3d axis() {
    const int k = below(6);
    if (k < 3) return Eigen::Vector3d::Unit(k);
    return k == 3 ? Eigen::Vector3d(0, 0, -1) : vec3();
  }
  JointModel joint() {
    const Eigen::Vector3d one = axis();
    switch (below(14)) {
      case 0:
        return JointModelContinuous(one);
      case 1:
      case 2:
        return JointModelPrismaticUnaligned(one);
      case 3:
        return JointModelHelicalUnaligned(one, in(-0.2, 0.2));
      case 4:
        return JointModelUniversal(one, one.unitOrthogonal() + 0.1 * vec3());
      case 5:
        return JointModelSpherical();
      case 6:
        return JointModelPlanar(one);
      case 7:
        return JointModelTranslation();
      case 8:
        return JointModelFreeFlyer();
      default:
        return JointModelRevoluteUnaligned(one);
    }
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace

Model randomTree(std::uint64_t seed, const RandomTree& options) {
  if (options.joints < 1) throw std::invalid_argument("randomTree: joints must be at least 1");
  Random random(seed);
  Model model;
  model.name = "tree" + std::to_string(seed);
  const JointIndex root = options.floating_base ? 1 : 0;
  std::vector<JointIndex> single;  // joints of one dof
  for (int i = 1; i <= options.joints; ++i) {
    const bool base = options.floating_base && i == 1;
    JointIndex parent = base ? 0 : std::max(root, random.below(i));
    if (options.depth_first && !base) {
      // climb a random number of joints from the one added last
      parent = i - 1;
      for (int up = random.below(3); up > 0 && parent > root; --up) parent = model.parents[parent];
    }
    const JointModel kind = base ? JointModel(JointModelFreeFlyer()) : random.joint();
    const JointIndex joint = model.addJoint(parent, kind, random.pose(), "joint" + std::to_string(i));
    if (kind.kind_nv() == 1) single.push_back(joint);
    const Inertia body = random.inertia();
    model.appendBodyToJoint(joint, body, random.pose());
    model.addFrame(Frame("tool" + std::to_string(i), joint, random.pose(), OP_FRAME));
  }
  const int count = static_cast<int>(single.size());
  for (int k = 0; options.mimic && k < count / 3; ++k) {
    const JointIndex follower = single[random.below(count)];
    JointIndex leader = single[random.below(count)], top = leader;
    while (top >= 0 && top != follower) top = model.mimic(top).leader;
    if (top == follower) continue;
    const double multiplier = random.in(-2, 2);
    model.setMimic(follower, leader, multiplier, random.in(-1, 1));
  }
  model.appendBodyToJoint(0, random.inertia());
  for (double& x : model.armature) x = random.in(0, 0.2);
  return model;
}

}  // namespace rbd::buildModels
