// Triangle meshes in metres, ready to draw, and how arbitrary triangles become one.
// Triangles are counterclockwise seen from outside. Vertices are shared where the surface is smooth and
// doubled along creases, so that one normal per vertex is enough.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace lab::render {

using Bounds = Eigen::AlignedBox3d;  // isEmpty() until something was added

// An image that is laid over surfaces: four bytes a pixel (red, green, blue, alpha), row 0 at the top.
struct Texture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;  // width * height * 4
  std::string file;           // the PNG or JPEG that it was decoded from, for the mesh cache; may be empty
};

// A range of triangles of one material, drawn in one call.
struct Surface {
  uint32_t first = 0, count = 0;  // in Mesh::indices; multiples of 3
  Eigen::Vector4f rgba{0.8f, 0.8f, 0.8f, 1.0f};
  float roughness = 0.45f;                 // 0: sharp highlight, 1: practically none
  std::shared_ptr<const Texture> texture;  // multiplies the colour; needs Mesh::uvs
  bool coloured = false;   // the file itself gave the colour; otherwise the Part's colour is used
  bool two_sided = false;  // its back can be seen: both sides are drawn, or holes would show
};

struct Mesh {
  std::vector<Eigen::Vector3f> positions, normals;  // one normal per position, unit length
  std::vector<Eigen::Vector2f> uvs;      // one per position or none: 0..1, u to the right, v up the texture
  std::vector<Eigen::Vector4f> colours;  // one per position or none: sRGB, multiplies the surface's colour
  std::vector<uint32_t> indices;         // three per triangle
  std::vector<Surface> surfaces;         // cover all indices
  Bounds bounds;

  size_t triangles() const { return indices.size() / 3; }
};

using MeshPtr = std::shared_ptr<const Mesh>;

// Triangles from any source.
struct Soup {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  // one per position, or none at all; (0, 0, 0) = unknown
  std::vector<Eigen::Vector2f> uvs;      // one per position, or none at all
  std::vector<uint32_t> indices;         // three per triangle
  std::vector<Surface> looks;            // colour, roughness and texture; the rest of a Surface is not read
  std::vector<uint32_t> triangle_look;   // one of looks per triangle, or none at all: uncoloured
};

// A mesh to draw: triangles without area dropped, equal positions welded, inside-out pieces flipped, and those
// triangles found whose back can be seen from outside. Given normals are kept if nearly all of them agree with
// their triangles; otherwise normals are computed, with creases where the surface bends by more than `crease`
// radians. Throws std::invalid_argument for arrays of unequal length, an index out of range, a non-finite
// coordinate, or nothing left to draw.
MeshPtr make_mesh(const Soup& soup, double crease = 0.7);

}  // namespace lab::render
