// Mesh files written here, byte by byte, so that what must come out is known.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "render/mesh.h"

namespace lab::render {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

class MeshFileTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "lab_mesh_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    return (folder_ / name).string();
  }
  // Refused with a message that starts with the path and says `what`.
  void expect_refused(const std::string& path, const std::string& what) {
    try {
      load_mesh(path);
      ADD_FAILURE() << path << " was accepted";
    } catch (const std::runtime_error& e) {
      const std::string text = e.what();
      EXPECT_EQ(text.find(path + ": "), 0u) << text;
      EXPECT_NE(text.find(what), std::string::npos) << text;
      EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    }
  }

  fs::path folder_;
};

std::string ascii_stl(const Mesh& m, bool cut = false) {
  std::string s = "solid test\n";
  for (size_t i = 0; i < m.indices.size(); i += 3) {
    s += "facet normal 0 0 0\nouter loop\n";
    for (int k = 0; k < 3; ++k) {
      const auto& p = m.positions[m.indices[i + k]];
      s += "vertex " + std::to_string(p[0]) + " " + std::to_string(p[1]) + " " + std::to_string(p[2]) + "\n";
    }
    s += "endloop\nendfacet\n";
  }
  return cut ? s.substr(0, s.size() / 2) : s + "endsolid test\n";
}

std::string binary_stl(const Mesh& m, uint32_t claimed = 0) {
  std::string s(80, ' ');
  std::memcpy(s.data(), "solid looks like text but is binary", 35);  // real exporters do this
  const uint32_t count = claimed ? claimed : static_cast<uint32_t>(m.triangles());
  s.append(reinterpret_cast<const char*>(&count), 4);
  for (size_t i = 0; i < m.indices.size(); i += 3) {
    s.append(12, '\0');
    for (int k = 0; k < 3; ++k)
      s.append(reinterpret_cast<const char*>(m.positions[m.indices[i + k]].data()), 12);
    s.append(2, '\0');
  }
  return s;
}

TEST_F(MeshFileTest, Stl) {
  const MeshPtr box = make_box({.25, .5, .75});
  for (const std::string& path : {write("a.stl", ascii_stl(*box)), write("b.STL", binary_stl(*box))}) {
    const MeshPtr m = load_mesh(path);
    EXPECT_EQ(m->triangles(), 12u) << path;
    EXPECT_EQ(m->positions.size(), 24u) << path;
    EXPECT_TRUE(m->bounds.isApprox(box->bounds, 1e-6)) << path;
    ASSERT_EQ(m->surfaces.size(), 1u);
    EXPECT_FALSE(m->surfaces[0].coloured) << "STL has no colour of its own";
    EXPECT_FALSE(m->surfaces[0].two_sided);
  }
}

TEST_F(MeshFileTest, ObjWithMaterials) {
  write("a.mtl", "newmtl red\nKd 0.9 0.1 0.05\nnewmtl glass\nKd 0 0 1\nd 0.25\n");
  const std::string head = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n";
  const std::string bottom = "f 4 3 2 1\n", rest = "f 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
  const MeshPtr m =
      load_mesh(write("a.obj", "mtllib a.mtl\n" + head + "usemtl red\n" + bottom + "usemtl glass\n" + rest));
  EXPECT_EQ(m->triangles(), 12u);
  ASSERT_EQ(m->surfaces.size(), 2u);
  const Surface& red = m->surfaces[m->surfaces[0].count == 6 ? 0 : 1];
  const Surface& glass = m->surfaces[m->surfaces[0].count == 6 ? 1 : 0];
  EXPECT_TRUE(red.coloured);
  EXPECT_TRUE(red.rgba.isApprox(Eigen::Vector4f(.9f, .1f, .05f, 1), 1e-5f)) << red.rgba.transpose();
  EXPECT_TRUE(glass.rgba.isApprox(Eigen::Vector4f(0, 0, 1, .25f), 1e-5f)) << glass.rgba.transpose();
  EXPECT_FALSE(glass.two_sided) << "closed as a whole, though not each colour alone";

  const MeshPtr plain = load_mesh(write("b.obj", head + bottom + rest));
  ASSERT_EQ(plain->surfaces.size(), 1u);
  EXPECT_FALSE(plain->surfaces[0].coloured);
}

// A tetrahedron (0, x, y, z) with legs 1000, 2000, 3000 in millimetres, green, moved by a node, in a Y_UP
// file.
std::string collada(const std::string& matrix, const std::string& up) {
  return R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="millimeter" meter="0.001"/><up_axis>)" +
         up + R"(</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse><color>0.1 0.8 0.2 1</color></diffuse>
</lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m" name="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 1000 0 0 0 2000 0 0 0 3000</float_array><technique_common>
<accessor source="#pa" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="s" count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="vs"><node id="n"><matrix>)" +
         matrix + R"(</matrix>
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="s" target="#m"/>
</technique_common></bind_material></instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#vs"/></scene></COLLADA>)";
}

TEST_F(MeshFileTest, ColladaAppliesNodesAndUnitButNotTheUpAxis) {
  // turned by 90 degrees about z: (x, y, z) -> (-y, x, z), then moved by (0, 0, 500) mm
  for (const char* up : {"Y_UP", "Z_UP"}) {
    const MeshPtr m = load_mesh(write("a.dae", collada("0 -1 0 0  1 0 0 0  0 0 1 500  0 0 0 1", up)));
    EXPECT_TRUE(m->bounds.isApprox(Bounds(Vector3d(-2, 0, .5), Vector3d(0, 1, 3.5)), 1e-5))
        << up << ": " << m->bounds.min().transpose() << " to " << m->bounds.max().transpose();
    ASSERT_EQ(m->surfaces.size(), 1u);
    EXPECT_TRUE(m->surfaces[0].rgba.isApprox(Eigen::Vector4f(.1f, .8f, .2f, 1), 1e-5f));
    EXPECT_TRUE(m->surfaces[0].coloured);
  }
}

TEST_F(MeshFileTest, MirroredNodeStaysRightSideOut) {
  const MeshPtr m = load_mesh(write("a.dae", collada("-1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1", "Z_UP")));
  double volume = 0;
  for (size_t i = 0; i < m->indices.size(); i += 3) {
    const auto p = [&](size_t k) { return Vector3d(m->positions[m->indices[i + k]].cast<double>()); };
    volume += p(0).dot(p(1).cross(p(2))) / 6;
  }
  EXPECT_NEAR(volume, 1.0, 1e-5);  // 1 * 2 * 3 / 6
}

TEST_F(MeshFileTest, BrokenFilesAreRefusedInOneLine) {
  const MeshPtr box = make_box({1, 1, 1});
  const std::string binary = binary_stl(*box), dae = collada("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "Z_UP");
  expect_refused((folder_ / "none.stl").string(), "No such file");
  expect_refused(folder_.string(), "");
  expect_refused(write("empty.stl", ""), "neither");
  expect_refused(write("empty.dae", ""), "");
  expect_refused(write("empty.obj", ""), "");
  expect_refused(write("cut_binary.stl", binary.substr(0, binary.size() - 7)), "");
  expect_refused(write("cut_ascii.stl", ascii_stl(*box, true)), "endsolid");
  expect_refused(write("cut.dae", dae.substr(0, dae.size() / 2)), "");
  expect_refused(write("count.stl", binary_stl(*box, 4'000'000'000u)), "");
  expect_refused(write("words.stl",
                       "this file holds nothing but words, more of them than an STL header is long, no, "
                       "really, only words"),
                 "binary STL");
  expect_refused(write("stl.dae", binary), "");
  expect_refused(write("mesh.xyz", "1 2 3"), "");
  expect_refused(write("index.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 900\n"), "");
  expect_refused(write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "");
  Mesh nan = *box;
  nan.positions[3].x() = NAN;
  expect_refused(write("nan.stl", binary_stl(nan)), "finite");
  nan.positions[3].x() = INFINITY;
  expect_refused(write("inf.stl", binary_stl(nan)), "finite");
}

}  // namespace
}  // namespace lab::render
