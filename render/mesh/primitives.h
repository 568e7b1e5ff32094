// Meshes of boxes, cylinders, cones, spheres and capsules, with exact normals.
#pragma once

#include "render/mesh/mesh.h"

namespace lab::render {

// Primitives as in URDF: centred at the origin, axis along z. A capsule's length is that of its straight
// part. Throw std::invalid_argument unless all sizes are finite and positive (a capsule's length may be 0)
// and segments is 3..1024.
MeshPtr make_box(const Eigen::Vector3d& size);
MeshPtr make_cylinder(double radius, double length, int segments = 48);
MeshPtr make_cone(double radius, double length, int segments = 48);  // its base at the origin, its tip at +z
MeshPtr make_sphere(double radius, int segments = 48);
MeshPtr make_capsule(double radius, double length, int segments = 48);

}  // namespace lab::render
