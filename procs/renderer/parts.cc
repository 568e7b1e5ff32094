#include "procs/renderer/parts.h"

#include "render/mesh/primitives.h"

namespace lab::renderer {
namespace {

constexpr size_t kFewTriangles = 500;

render::MeshPtr primitive(const rbd::GeometryObject& shape) {
  switch (shape.shape) {
    case rbd::Shape::Box:
      return render::make_box(shape.size);
    case rbd::Shape::Cylinder:
      return render::make_cylinder(shape.size[0], shape.size[1]);
    case rbd::Shape::Sphere:
      return render::make_sphere(shape.size[0]);
    case rbd::Shape::Capsule:
      return render::make_capsule(shape.size[0], shape.size[1]);
    case rbd::Shape::Mesh:
      break;
  }
  return nullptr;
}

}  // namespace

Eigen::Isometry3d isometry(const rbd::SE3& pose) {
  Eigen::Isometry3d out = Eigen::Isometry3d::Identity();
  out.linear() = pose.rotation();
  out.translation() = pose.translation();
  return out;
}

std::string PartMaker::why_missing(const std::string& uri) const {
  for (std::string warning : robot_.warnings)  // the loader has said where it looked
    if (warning.find("mesh '" + uri + "'") != std::string::npos) {
      if (const size_t word = warning.find(" warning:"); word != std::string::npos) warning.erase(word, 9);
      return warning;
    }
  return "mesh '" + uri + "' not found";
}

render::MeshPtr PartMaker::mesh(const rbd::GeometryObject& shape) {
  const double largest = shape.scale.cwiseAbs().maxCoeff();
  const auto [known, is_new] = meshes_.try_emplace({shape.meshUri, largest});
  if (!is_new) return known->second;
  try {
    if (shape.mesh.empty()) throw std::runtime_error(why_missing(shape.meshUri));
    render::MeshOptions options;
    if (error_ > 0 && largest > 0) {
      options.triangles = kFewTriangles;
      options.error = error_ / largest;
    }
    known->second = render::load_mesh(shape.mesh, options, &warnings_);
  } catch (const std::exception& error) {
    warnings_.push_back(std::string(error.what()) + "; drawn as a magenta box");
  }
  return known->second;
}

render::Part PartMaker::part(const rbd::GeometryObject& shape) {
  render::Part part;
  part.pose = isometry(shape.placement);
  if (shape.hasColor) part.rgba = shape.rgba.cast<float>();
  if (shape.shape != rbd::Shape::Mesh) {
    part.mesh = primitive(shape);
    return part;
  }
  part.mesh = mesh(shape);
  part.scale = shape.scale;
  if (part.mesh) return part;
  part.mesh = render::make_box({0.1, 0.1, 0.1});
  part.scale.setOnes();
  part.rgba = {1, 0, 1, 1};
  return part;
}

}  // namespace lab::renderer
