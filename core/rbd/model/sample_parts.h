// The sample robots as tables: one row per joint with the body it carries. Model and pictures are made from
// the same rows, so they cannot disagree. Inner header of sample_models.cc and sample_geometries.cc;
// docs/sample_models.md.
#pragma once

#include <vector>

#include "rbd/model/geometry.h"
#include "rbd/model/model.h"

namespace rbd::buildModels {

struct SamplePart {
  const char* joint;       // "universe" for what stands on the ground
  const char* parent;      // joint
  char axis;               // x, y, z: revolute; f: free-flyer
  Eigen::Vector3d origin;  // of the joint in its parent (m)
  double pitch;            // turn of the joint's frame about the parent's y (rad)
  Shape shape;             // of the body
  Eigen::Vector3d size;    // as in GeometryObject (m)
  Eigen::Vector3d centre;  // of the body in the joint's frame (m)
  double mass;             // kg, spread evenly over the shape
};

std::vector<SamplePart> manipulatorParts();
std::vector<SamplePart> humanoidParts();

}  // namespace rbd::buildModels
