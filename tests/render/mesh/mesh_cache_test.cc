#include "render/mesh/mesh_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "render/mesh/mesh_file.h"
#include "render/png.h"

namespace lab::render {
namespace {

namespace fs = std::filesystem;

class MeshCacheTest : public ::testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "lab_cache_XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    options_.cache = (folder_ / "cache").string();
    write("a.obj",
          "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl m\n"
          "f 1/1 3/2 2/3\nf 1/1 2/2 4/3\nf 1/1 4/2 3/3\nf 2/1 3/2 4/3\n");
    write("a.mtl", "newmtl m\nKd 0.2 0.4 0.6\nmap_Kd a.png\n");
    Image picture(4, 2);
    for (size_t i = 0; i < picture.rgb.size(); ++i) picture.rgb[i] = static_cast<uint8_t>(10 * i);
    write_png((folder_ / "a.png").string(), picture);
  }
  void TearDown() override { fs::remove_all(folder_); }
  void write(const std::string& name, const std::string& bytes) {
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  MeshPtr load(const std::string& name = "a.obj") {
    warnings_.clear();
    return load_mesh((folder_ / name).string(), options_, &warnings_);
  }
  std::vector<fs::path> entries() const {
    std::vector<fs::path> out;
    if (fs::exists(options_.cache))
      for (const auto& item : fs::directory_iterator(options_.cache)) out.push_back(item.path());
    return out;
  }

  fs::path folder_;
  MeshOptions options_;
  std::vector<std::string> warnings_;
};

void expect_same(const Mesh& a, const Mesh& b) {
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_EQ(a.uvs, b.uvs);
  EXPECT_EQ(a.indices, b.indices);
  EXPECT_TRUE(a.bounds.isApprox(b.bounds));
  ASSERT_EQ(a.surfaces.size(), b.surfaces.size());
  for (size_t i = 0; i < a.surfaces.size(); ++i) {
    const Surface &s = a.surfaces[i], &t = b.surfaces[i];
    EXPECT_EQ(s.first, t.first);
    EXPECT_EQ(s.count, t.count);
    EXPECT_EQ(s.rgba, t.rgba);
    EXPECT_EQ(s.roughness, t.roughness);
    EXPECT_EQ(s.coloured, t.coloured);
    EXPECT_EQ(s.two_sided, t.two_sided);
    ASSERT_EQ(!s.texture, !t.texture);
    if (s.texture) {
      EXPECT_EQ(s.texture->rgba, t.texture->rgba);
    }
  }
}

TEST_F(MeshCacheTest, TheSecondReadIsTheSame) {
  const MeshPtr first = load();
  EXPECT_TRUE(warnings_.empty());
  ASSERT_EQ(entries().size(), 1u);
  ASSERT_TRUE(first->surfaces[0].texture);
  EXPECT_EQ(first->surfaces[0].texture->width, 4);

  const auto before = fs::last_write_time(entries()[0]);
  fs::last_write_time(entries()[0], before - std::chrono::hours(1));
  expect_same(*load(), *first);
  EXPECT_GE(fs::last_write_time(entries()[0]), before) << "marked as used";
  EXPECT_EQ(entries().size(), 1u);
}

TEST_F(MeshCacheTest, OptionsAndContentHaveEntriesOfTheirOwn) {
  load();
  options_.triangles = 2;
  options_.error = 0.1;
  load();
  EXPECT_EQ(entries().size(), 2u);
  write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  load("b.obj");
  EXPECT_EQ(entries().size(), 3u);
  fs::copy(folder_ / "b.obj", folder_ / "c.obj");
  load("c.obj");
  EXPECT_EQ(entries().size(), 3u) << "content counts, not the name";
}

TEST_F(MeshCacheTest, AChangedNeighbourIsSeen) {
  load();
  write("a.mtl", "newmtl m\nKd 0.9 0.4 0.6\n");
  const MeshPtr m = load();
  EXPECT_FALSE(m->surfaces[0].texture);
  EXPECT_NEAR(m->surfaces[0].rgba[0], 0.9, 1e-6);
  fs::remove(folder_ / "a.mtl");
  EXPECT_NE(load()->surfaces[0].rgba[0], m->surfaces[0].rgba[0]);
  ASSERT_EQ(warnings_.size(), 1u);
  EXPECT_NE(warnings_[0].find("a.mtl"), std::string::npos) << warnings_[0];
  write("a.mtl", "newmtl m\nKd 0.1 0.4 0.6\n");
  EXPECT_NEAR(load()->surfaces[0].rgba[0], 0.1, 1e-6) << "one that appears later is seen, too";
}

TEST_F(MeshCacheTest, WarningsAreKeptAndNameTheFileAtHand) {
  fs::remove(folder_ / "a.png");
  for (const char* name : {"a.obj", "a.obj"}) {
    load(name);
    ASSERT_EQ(warnings_.size(), 1u);
    EXPECT_EQ(warnings_[0].find((folder_ / name).string() + ": texture 'a.png': not found (tried "), 0u)
        << warnings_[0];
    EXPECT_NE(warnings_[0].find((folder_ / "a.png").string()), std::string::npos) << warnings_[0];
  }
}

TEST_F(MeshCacheTest, BrokenEntriesAreMadeAgain) {
  const MeshPtr good = load();
  const fs::path entry = entries().at(0);
  std::ifstream in(entry, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  ASSERT_GT(bytes.size(), 100u);
  const auto check = [&](const std::string& broken) {
    std::ofstream(entry, std::ios::binary) << broken;
    expect_same(*load(), *good);
    std::ifstream again(entry, std::ios::binary);
    EXPECT_EQ(std::string(std::istreambuf_iterator<char>(again), {}), bytes);
  };
  check("");
  check("rubbish");
  // After each the mesh is read and looked at from all around again, 0.8 s with sanitizers: ten of either kind.
  const size_t stride = std::max<size_t>(1, bytes.size() / 10);
  for (size_t cut = 1; cut < bytes.size(); cut += stride) check(bytes.substr(0, cut));
  for (size_t at = 0; at < bytes.size(); at += stride) {
    std::string flipped = bytes;
    flipped[at] ^= 0x10;
    check(flipped);
  }
  EXPECT_EQ(entries().size(), 1u) << "no half-written files are left";
}

TEST_F(MeshCacheTest, WorksWithoutACache) {
  options_.cache = "";
  EXPECT_EQ(load()->triangles(), 4u);
  options_.cache = (folder_ / "a.mtl" / "below a file").string();
  EXPECT_EQ(load()->triangles(), 4u);
}

TEST(MeshCacheFolder, FollowsTheEnvironment) {
  const auto set = [](const char* own, const char* xdg) {
    own ? setenv("LAB_MESH_CACHE", own, 1) : unsetenv("LAB_MESH_CACHE");
    xdg ? setenv("XDG_CACHE_HOME", xdg, 1) : unsetenv("XDG_CACHE_HOME");
  };
  set("/x", "/y");
  EXPECT_EQ(mesh_cache_folder(), "/x");
  set("off", "/y");
  EXPECT_EQ(mesh_cache_folder(), "");
  set(nullptr, "/y");
  EXPECT_EQ(mesh_cache_folder(), "/y/lcmlab/meshes");
  set(nullptr, nullptr);
}

}  // namespace
}  // namespace lab::render
