// Mesh files written here, byte by byte, so that what must come out is known.
#include "render/mesh/mesh_file.h"

#include <gtest/gtest.h>
#include <jpeglib.h>
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "render/mesh/primitives.h"
#include "render/mesh/texture.h"
#include "render/png.h"

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

TEST_F(MeshFileTest, HugeCountsAndWrongNamesAreRefusedInOneLine) {
  const MeshPtr box = make_box({1, 1, 1});
  const std::string dae = collada("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "Z_UP");
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = dae;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  expect_refused(write("count.dae", with("count=\"12\"", "count=\"4000000000\"")), "");
  expect_refused(write("nan.dae", with("1000 0 0", "nan 0 0")), "");
  expect_refused(write("index.dae", with("0 1 3", "0 1 7")), "");
  expect_refused(write("huge.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":4000000000}],
    "bufferViews":[{"buffer":0,"byteLength":4000000000}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":300000000,"type":"VEC3"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0})"),
                 "");
  expect_refused(write("really_stl.dae", binary_stl(*box)), "look like binary STL");
  expect_refused(write("really_stl.obj", ascii_stl(*box)), "look like ASCII STL");
  expect_refused(write("really_dae.stl", dae), "look like Collada");
  expect_refused(write("zero.stl", std::string(84, '\0')), "");
  expect_refused(write("flat.obj", "v 0 0 0\nv 1 1 1\nv 2 2 2\nf 1 2 3\n"), "no triangle with an area");
}

std::string base64(const std::string& bytes) {
  static const char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  for (size_t i = 0; i < bytes.size(); i += 3) {
    uint32_t v = 0;
    for (size_t k = 0; k < 3; ++k)
      v = v << 8 | (i + k < bytes.size() ? static_cast<uint8_t>(bytes[i + k]) : 0);
    for (size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : digits[v >> (18 - 6 * k) & 63];
  }
  return out;
}

std::string bytes_of(const std::string& path) {
  std::string bytes;
  EXPECT_TRUE(read_bytes(path, bytes)) << path;
  return bytes;
}

// One triangle in glTF, with its picture and numbers inside the file.
TEST_F(MeshFileTest, GltfKeepsItsAxesAndBringsItsTexture) {
  Image picture(2, 1);
  picture.rgb = {255, 0, 0, 0, 0, 255};
  write_png((folder_ / "p.png").string(), picture);
  const float numbers[] = {0, 0, 0, 1, 0, 0, 0, 2, 0, /* uv */ 0, 0, 1, 0, 0, 1};
  const std::string data(reinterpret_cast<const char*>(numbers), sizeof numbers);
  const std::string gltf =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":60,"uri":"data:application/octet-stream;base64,)" +
      base64(data) +
      R"("}],"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":36},{"buffer":0,"byteOffset":36,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,2,0]},
                 {"bufferView":1,"componentType":5126,"count":3,"type":"VEC2"}],
    "images":[{"uri":"data:image/png;base64,)" +
      base64(bytes_of((folder_ / "p.png").string())) + R"("}],"textures":[{"source":0}],
    "materials":[{"name":"m","pbrMetallicRoughness":{"baseColorFactor":[0.5,1,1,1],"roughnessFactor":0.25,"baseColorTexture":{"index":0}}}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0,"TEXCOORD_0":1},"material":0}]}],
    "nodes":[{"mesh":0,"translation":[0,0,3]}],"scenes":[{"nodes":[0]}],"scene":0})";
  const MeshFile file = read_mesh_file(write("a.gltf", gltf));
  EXPECT_TRUE(file.warnings.empty());
  const Mesh& m = *file.mesh;
  EXPECT_TRUE(m.bounds.isApprox(Bounds(Vector3d(0, 0, 3), Vector3d(1, 2, 3)), 1e-6))
      << "as in the file: y is not turned up";
  ASSERT_EQ(m.surfaces.size(), 1u);
  EXPECT_FLOAT_EQ(m.surfaces[0].roughness, 0.25f);
  EXPECT_FLOAT_EQ(m.surfaces[0].rgba[0], 0.5f);
  ASSERT_TRUE(m.surfaces[0].texture);
  EXPECT_EQ(m.surfaces[0].texture->rgba, (std::vector<uint8_t>{255, 0, 0, 255, 0, 0, 255, 255}));
  ASSERT_EQ(m.uvs.size(), 3u);
  for (size_t i = 0; i < 3; ++i) {  // glTF counts v from the top, we from the bottom
    EXPECT_FLOAT_EQ(m.uvs[i].x(), m.positions[i].x());
    EXPECT_FLOAT_EQ(m.uvs[i].y(), 1 - m.positions[i].y() / 2);
  }
}

std::string jpeg_of(int width, int height, uint8_t r, uint8_t g, uint8_t b) {
  jpeg_compress_struct info{};
  jpeg_error_mgr errors{};
  info.err = jpeg_std_error(&errors);
  jpeg_create_compress(&info);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&info, &data, &size);
  info.image_width = static_cast<JDIMENSION>(width);
  info.image_height = static_cast<JDIMENSION>(height);
  info.input_components = 3;
  info.in_color_space = JCS_RGB;
  jpeg_set_defaults(&info);
  jpeg_start_compress(&info, TRUE);
  std::vector<uint8_t> line;
  for (int x = 0; x < width; ++x) line.insert(line.end(), {r, g, b});
  JSAMPROW row = line.data();
  while (info.next_scanline < info.image_height) jpeg_write_scanlines(&info, &row, 1);
  jpeg_finish_compress(&info);
  jpeg_destroy_compress(&info);
  const std::string bytes(reinterpret_cast<char*>(data), size);
  std::free(data);
  return bytes;
}

TEST_F(MeshFileTest, ColladaTextures) {
  std::string text = collada("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 1", "Z_UP");
  const auto replace = [&](const std::string& from, const std::string& to) {
    text.replace(text.find(from), from.size(), to);
  };
  replace("<color>0.1 0.8 0.2 1</color>", R"(<texture texture="smp" texcoord="UV"/>)");
  replace(
      "<profile_COMMON>",
      R"(<profile_COMMON><newparam sid="srf"><surface type="2D"><init_from>img</init_from></surface></newparam>
    <newparam sid="smp"><sampler2D><source>srf</source></sampler2D></newparam>)");
  replace(
      "<library_effects>",
      R"(<library_images><image id="img"><init_from>C:\pictures\skin.jpg</init_from></image></library_images><library_effects>)");
  replace("<vertices",
          R"(<source id="t"><float_array id="ta" count="2">0.25 0.75</float_array><technique_common>
    <accessor source="#ta" count="1" stride="2"><param name="S" type="float"/><param name="T" type="float"/></accessor></technique_common></source><vertices)");
  replace(
      "offset=\"0\"/><p>0 2 1 0 1 3 0 3 2 1 2 3",
      R"(offset="0"/><input semantic="TEXCOORD" source="#t" offset="1" set="0"/><p>0 0 2 0 1 0 0 0 1 0 3 0 0 0 3 0 2 0 1 0 2 0 3 0)");
  const std::string path = write("a.dae", text);

  MeshFile file = read_mesh_file(path);  // the picture is not there yet
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_NE(file.warnings[0].find("skin.jpg"), std::string::npos) << file.warnings[0];
  EXPECT_FALSE(file.mesh->surfaces[0].texture);

  write("skin.jpg", jpeg_of(8, 16, 200, 100, 50));
  file = read_mesh_file(path);
  EXPECT_TRUE(file.warnings.empty());
  const Surface& s = file.mesh->surfaces.at(0);
  ASSERT_TRUE(s.texture);
  EXPECT_EQ(s.texture->width, 8);
  EXPECT_EQ(s.texture->height, 16);
  const int expected[] = {200, 100, 50, 255};
  for (size_t i = 0; i < s.texture->rgba.size(); ++i) EXPECT_NEAR(s.texture->rgba[i], expected[i % 4], 4);
  EXPECT_TRUE(s.rgba.isOnes()) << "the texture stands in place of the colour";
  for (const auto& uv : file.mesh->uvs) EXPECT_TRUE(uv.isApprox(Eigen::Vector2f(.25f, .75f)));

  const std::string whole = jpeg_of(64, 64, 1, 2, 3);
  for (const std::string& broken :
       {std::string("no picture"), std::string(), whole.substr(0, whole.size() / 2),
        std::string("\xff\xd8\xff"), std::string("\x89PNG\r\n")}) {
    write("skin.jpg", broken);
    file = read_mesh_file(path);
    ASSERT_EQ(file.warnings.size(), 1u);
    EXPECT_FALSE(file.mesh->surfaces[0].texture);
  }
}

}  // namespace
}  // namespace lab::render
