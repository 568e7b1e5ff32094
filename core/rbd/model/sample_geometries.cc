#include "rbd/model/sample_geometries.h"

#include <string>

#include "rbd/model/sample_parts.h"

namespace rbd::buildModels {
namespace {

// Grey on the ground, then blue and orange in turn, so that neighbours are told apart.
Eigen::Vector4d colour(int row, bool ground) {
  if (ground) return {0.45, 0.45, 0.48, 1};
  return row % 2 ? Eigen::Vector4d(0.20, 0.42, 0.68, 1) : Eigen::Vector4d(0.92, 0.55, 0.18, 1);
}

GeometryModel geometries(const Model& model, const std::vector<SamplePart>& parts) {
  GeometryModel out;
  int row = 0;
  for (const SamplePart& part : parts) {
    GeometryObject shape;
    shape.name = std::string(part.joint) + "_0";
    shape.parentJoint = model.jointId(part.joint);
    shape.parentFrame = model.frameId(part.joint);
    shape.placement = SE3(Eigen::Matrix3d::Identity(), part.centre);
    shape.shape = part.shape;
    shape.size = part.size;
    shape.hasColor = true;
    shape.rgba = colour(row++, shape.parentJoint == 0);
    out.visual.push_back(shape);
  }
  out.collision = out.visual;
  return out;
}

}  // namespace

GeometryModel manipulatorGeometries(const Model& model) { return geometries(model, manipulatorParts()); }
GeometryModel humanoidGeometries(const Model& model) { return geometries(model, humanoidParts()); }

}  // namespace rbd::buildModels
