// Triangle meshes in metres: generated primitives and files (STL, Collada, OBJ, glTF) through assimp.
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

// A picture that is laid over surfaces: four bytes a pixel (red, green, blue, alpha), row 0 at the top.
struct Texture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgba;  // width * height * 4
  std::string file;           // the PNG or JPEG that it was decoded from, for the mesh cache; may be empty
};

// A run of triangles drawn in one go.
struct Surface {
  uint32_t first = 0, count = 0;  // in Mesh::indices; multiples of 3
  Eigen::Vector4f rgba{0.8f, 0.8f, 0.8f, 1.0f};
  float roughness = 0.45f;                 // 0 a mirror's sharp highlight, 1 none to speak of
  std::shared_ptr<const Texture> texture;  // multiplies the colour; needs Mesh::uvs
  bool coloured = false;   // the file itself gave the colour; otherwise the Part's colour is used
  bool two_sided = false;  // its back can be seen: both sides are drawn, so that nothing shows a hole
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

// Primitives as in URDF: centred at the origin, axis along z. A capsule's length is that of its straight
// part. Throw std::invalid_argument unless all sizes are finite and positive (a capsule's length may be 0)
// and segments is 3..1024.
MeshPtr make_box(const Eigen::Vector3d& size);
MeshPtr make_cylinder(double radius, double length, int segments = 48);
MeshPtr make_cone(double radius, double length, int segments = 48);  // its base at the origin, its tip at +z
MeshPtr make_sphere(double radius, int segments = 48);
MeshPtr make_capsule(double radius, double length, int segments = 48);

// Triangles as they come from anywhere.
struct Soup {
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  // one per position, or none at all; (0, 0, 0) = unknown
  std::vector<Eigen::Vector2f> uvs;      // one per position, or none at all
  std::vector<uint32_t> indices;         // three per triangle
  std::vector<Surface> looks;            // colour, roughness and texture; the rest of a Surface is not read
  std::vector<uint32_t> triangle_look;   // one of looks per triangle, or none at all: uncoloured
};

// A mesh to draw: triangles without area dropped, equal positions welded, inside-out pieces turned, and those
// triangles found whose back can be seen from outside. Given normals are kept if nearly all of them suit
// their triangles; otherwise normals are made, with creases where the surface bends by more than `crease`
// radians. Throws std::invalid_argument for arrays of unequal length, an index out of range, a non-finite
// coordinate, or nothing left to draw.
MeshPtr make_mesh(const Soup& soup, double crease = 0.7);

// Fewer triangles for nearly the same picture: vertices are moved onto their neighbours, cheapest first,
// until `triangles` are left or the next move would leave the surface by more than `error` metres (distance
// to the planes of all triangles that a vertex stands for; 0 = flat parts only). Corners, seams of colour or
// texture and rims of holes stay, and so do creases; normals are made anew, from what is left. Deterministic.
MeshPtr decimate(const Mesh& mesh, size_t triangles, double error);

// Reads .stl, .dae, .obj, .gltf or .glb (any assimp can). Node transforms and the Collada unit are applied,
// up axes are NOT (Collada's up_axis, glTF's y up): robots are drawn in the file's own axes, as RViz does.
// STL has no colour of its own. Textures (PNG, JPEG) are looked for beside the mesh, or inside it; one that
// cannot be read is left out. Throws std::runtime_error "PATH: reason" for a missing, cut, foreign, empty,
// non-finite or absurdly large file.
MeshPtr load_mesh(const std::string& path);

}  // namespace lab::render
