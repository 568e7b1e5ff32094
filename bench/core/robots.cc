// Writes one robot and its states as the text that all programs of `lab bench core` read (harness.h): the
// same numbers for all programs. Fixed joints are merged away; armature is left out, because not every peer
// knows it.
//
// usage: bench-robots NAME SOURCE [--floating] [--lock WORD]
//   SOURCE   a URDF file, builtin:manipulator, builtin:humanoid, chain:N or tree:N (binary) of N revolute
//   joints
//   --lock   joints whose name holds WORD are welded at zero
#include <rbd/rbd.h>
#include <rbd/urdf/urdf.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>
#include <stdexcept>
#include <string>

namespace {

using Random = std::mt19937_64;

// even in [low, high], the same on every machine (std::uniform_real_distribution is not)
double even(Random& random, double low, double high) {
  return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

Eigen::Vector3d vector(Random& random, double scale) {
  const double x = even(random, -scale, scale), y = even(random, -scale, scale);
  return {x, y, even(random, -scale, scale)};
}

// A link of about 1 kg and 0.3 m and its joint; axes take turns. Returns the joint's index.
int addLink(rbd::Model& model, int parent, Random& random) {
  const int n = model.njoints;
  const Eigen::Vector3d axis = Eigen::Vector3d::Unit(n % 3);
  const rbd::SE3 place(Eigen::AngleAxisd(even(random, -1, 1), vector(random, 1).normalized()).matrix(),
                       Eigen::Vector3d(0, 0, 0.3) + vector(random, 0.05));
  const int joint =
      model.addJoint(parent, rbd::JointModelRevoluteUnaligned(axis), place, "j" + std::to_string(n));
  model.appendBodyToJoint(joint, rbd::Inertia::FromBox(even(random, 0.5, 1.5), 0.1, 0.12, 0.3),
                          rbd::SE3(Eigen::Matrix3d::Identity(), vector(random, 0.1)));
  return joint;
}

// n joints below `parent`, the two halves of what is left below the first of them.
void addTree(rbd::Model& model, int parent, int n, Random& random) {
  if (n == 0) return;
  const int joint = addLink(model, parent, random);
  addTree(model, joint, n / 2, random);
  addTree(model, joint, n - 1 - n / 2, random);
}

rbd::Model load(const std::string& source, bool floating) {
  rbd::Model model;
  Random random(1);
  const auto count = [&] { return std::stoi(source.substr(source.find(':') + 1)); };
  if (source == "builtin:manipulator") {
    rbd::buildModels::manipulator(model);
  } else if (source == "builtin:humanoid") {
    rbd::buildModels::humanoid(model);
  } else if (source.rfind("chain:", 0) == 0) {
    for (int i = 0, tip = 0; i < count(); ++i) tip = addLink(model, tip, random);
  } else if (source.rfind("tree:", 0) == 0) {
    addTree(model, 0, count(), random);
  } else {
    rbd::urdf::Options options;
    options.floating_base = floating;
    options.mimic = false;  // not every peer knows mimic joints
    options.meshes = false;
    rbd::urdf::buildModel(source, model, options);
  }
  return model;
}

// The same robot with the joints that match `word` welded at zero, without limits and armature.
rbd::Model lock(const rbd::Model& full, const std::string& word) {
  rbd::Model model;
  std::vector<int> joint(static_cast<std::size_t>(full.njoints), 0);    // where each moving part went
  std::vector<rbd::SE3> place(static_cast<std::size_t>(full.njoints));  // and how it sits there
  for (int i = 1; i < full.njoints; ++i) {
    const std::size_t k = static_cast<std::size_t>(i), parent = static_cast<std::size_t>(full.parents[k]);
    const rbd::SE3 X = place[parent] * full.jointPlacements[k];
    if (!word.empty() && full.names[k].find(word) != std::string::npos) {
      joint[k] = joint[parent];
      place[k] = X;
    } else {
      joint[k] = model.addJoint(joint[parent], full.joints[k], X, full.names[k]);
    }
    if (joint[k] > 0) model.appendBodyToJoint(joint[k], full.inertias[k], place[k]);
  }
  return model;
}

void print(const double* x, Eigen::Index n) {
  for (Eigen::Index i = 0; i < n; ++i) std::printf(" %.17g", x[i]);
}

const char* kind(const rbd::JointModel& joint, const std::string& name) {
  switch (joint.kind()) {
    case rbd::JointKind::Revolute:
    case rbd::JointKind::Continuous:
      return "revolute";
    case rbd::JointKind::Prismatic:
      return "prismatic";
    case rbd::JointKind::FreeFlyer:
      return "freeflyer";
    default:
      throw std::invalid_argument("joint '" + name + "' is " + joint.shortname() +
                                  ", which not every peer has");
  }
}

void write(const std::string& name, const rbd::Model& model) {
  std::printf("robot %s %d %d\n", name.c_str(), model.nq, model.nv);
  for (int i = 1; i < model.njoints; ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const rbd::SE3& X = model.jointPlacements[k];
    const rbd::Inertia& Y = model.inertias[k];
    const Eigen::Matrix3d byRows = X.rotation().transpose(), I = Y.inertia();
    const double mass = Y.mass(), moments[] = {I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)};
    std::printf("joint j%d %d %s", i, model.parents[k], kind(model.joints[k], model.names[k]));
    print(model.joints[k].axis().data(), 3);
    print(byRows.data(), 9);
    print(X.translation().data(), 3);
    print(&mass, 1);
    print(Y.lever().data(), 3);
    print(moments, 6);
    std::printf("\n");
  }
  Random random(2);
  const int states =
      model.nv > 100 ? 16 : 128;  // so that the largest robots' states stay in the cache as well
  for (int s = 0; s < states; ++s) {
    const Eigen::VectorXd q = rbd::randomConfiguration(model, random);
    std::printf("state");
    print(q.data(), model.nq);
    for (int i = 0; i < 3 * model.nv; ++i) std::printf(" %.17g", even(random, -1, 1));  // v, a, tau
    std::printf("\n");
  }
}

}  // namespace

int main(int argc, char** argv) {
  bool floating = false;
  std::string word, plain[2];
  int given = 0;
  for (int i = 1; i < argc; ++i) {
    if (!std::strcmp(argv[i], "--floating")) {
      floating = true;
    } else if (!std::strcmp(argv[i], "--lock") && i + 1 < argc) {
      word = argv[++i];
    } else if (given < 2) {
      plain[given++] = argv[i];
    }
  }
  if (given < 2) {
    std::fprintf(stderr, "usage: bench-robots NAME SOURCE [--floating] [--lock WORD]\n");
    return 2;
  }
  try {
    write(plain[0], lock(load(plain[1], floating), word));
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s\n", e.what());
    return 3;
  }
}
