// What Debian's urdfdom makes of one file, for urdf_corpus.py: exit 0 and "finite" or "nan" when it returns a
// model, 1 when it refuses. Its messages go to stderr as it likes.
//
// usage: urdfdom_read FILE
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <iterator>

namespace {

bool finite(const urdf::Pose& p) {
  const urdf::Rotation& r = p.rotation;
  return std::isfinite(p.position.x + p.position.y + p.position.z + r.x + r.y + r.z + r.w);
}

bool finite(const urdf::ModelInterface& model) {
  for (const auto& [name, link] : model.links_) {
    if (!link->inertial) continue;
    const urdf::Inertial& i = *link->inertial;
    if (!std::isfinite(i.mass + i.ixx + i.ixy + i.ixz + i.iyy + i.iyz + i.izz) || !finite(i.origin))
      return false;
  }
  for (const auto& [name, joint] : model.joints_) {
    if (!finite(joint->parent_to_joint_origin_transform)) return false;
    if (!std::isfinite(joint->axis.x + joint->axis.y + joint->axis.z)) return false;
  }
  return true;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  std::ifstream in(argv[1], std::ios::binary);
  const std::string text(std::istreambuf_iterator<char>(in), {});
  const urdf::ModelInterfaceSharedPtr model = urdf::parseURDF(text);
  if (!model) return 1;
  std::cout << (finite(*model) ? "finite" : "nan") << std::endl;
}
