// Decimation: fewer triangles for nearly the same picture. Half-edge collapses ordered by quadric error (Garland and
// Heckbert 1997, "Surface simplification using quadric error metrics").
#pragma once

#include "render/mesh/mesh.h"

namespace lab::render {

// Vertices are moved onto their neighbours, cheapest first,
// until `triangles` are left or the next move would leave the surface by more than `error` metres (distance
// to the planes of all triangles that a vertex stands for; 0 = flat parts only). Corners, creases, seams of
// colour or texture and rims of holes are kept; normals are recomputed from the result. Deterministic.
MeshPtr decimate(const Mesh& mesh, size_t triangles, double error);

}  // namespace lab::render
