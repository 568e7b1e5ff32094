// Short files whose nodes stand for more copies than fit into memory: refused at once, in one line.
#include "render/mesh/node_graph.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <functional>

#include "render/mesh/mesh_file.h"

namespace lab::render {
namespace {

namespace fs = std::filesystem;

std::string fault_of(const NodeGraph& graph) {
  try {
    graph.check();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

/// Nodes 0 .. levels, each with `copies` times the next one.
std::string gltf_chain(int levels, int copies) {
  std::string nodes;
  for (int i = 0; i <= levels; ++i) {
    std::string children;
    for (int k = 0; k < copies && i < levels; ++k) children += (k ? "," : "") + std::to_string(i + 1);
    nodes += (i ? "," : "") + (children.empty() ? std::string("{}") : "{\"children\":[" + children + "]}");
  }
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[)" + nodes + "]}";
}

std::string collada_chain(int levels, int copies) {
  std::string nodes;
  for (int i = 0; i < levels; ++i) {
    nodes += "<node id=\"n" + std::to_string(i) + "\">";
    for (int k = 0; k < copies; ++k) nodes += "<instance_node url='#n" + std::to_string(i + 1) + "'/>";
    nodes += "</node>";
  }
  return "<COLLADA version=\"1.4.1\"><library_nodes>" + nodes + "<node id=\"n" + std::to_string(levels) +
         "\"/></library_nodes><library_visual_scenes><visual_scene id=\"s\"><node><instance_node "
         "url=\"#n0\"/></node>"
         "</visual_scene></library_visual_scenes></COLLADA>";
}

/// The same text inside a .glb.
std::string glb(const std::string& json) {
  const auto number = [](uint32_t x) {
    return std::string{char(x), char(x >> 8), char(x >> 16), char(x >> 24)};
  };
  return "glTF" + number(2) + number(static_cast<uint32_t>(20 + json.size())) +
         number(static_cast<uint32_t>(json.size())) + "JSON" + json;
}

TEST(NodeGraph, OrdinaryTreesPass) {
  for (const std::string& text : {gltf_chain(3, 2), glb(gltf_chain(3, 2)), gltf_chain(900, 1),
                                  std::string("{}"), std::string("no JSON")})
    EXPECT_EQ(fault_of(gltf_nodes(text)), "");
  EXPECT_EQ(fault_of(collada_nodes(collada_chain(3, 2))), "");
  EXPECT_EQ(fault_of(collada_nodes("<node id='a'><node/><node/></node><nodes/>")), "");
}

TEST(NodeGraph, NodesThatDoubleAtEveryLevelAreTooMany) {
  const std::string too_many = "its nodes name each other so often that it has more than 100000 of them";
  for (const int levels : {17, 40, 64, 500}) {  // 2^17 > 100000; 2^64 and more would overflow a count
    EXPECT_EQ(fault_of(gltf_nodes(gltf_chain(levels, 2))), too_many) << levels;
    EXPECT_EQ(fault_of(gltf_nodes(glb(gltf_chain(levels, 2)))), too_many) << levels;
    EXPECT_EQ(fault_of(collada_nodes(collada_chain(levels, 2))), too_many) << levels;
  }
  EXPECT_EQ(fault_of(gltf_nodes(gltf_chain(15, 2))), "");
  std::string often = R"({"scenes":[{"nodes":[0)";
  for (int i = 0; i < 20'000; ++i) often += ",0";
  EXPECT_EQ(fault_of(gltf_nodes(often + R"(]}],"nodes":[{"children":[1,2,3,4,5]}]})")), too_many);
}

TEST(NodeGraph, APartOfItselfIsRefused) {
  EXPECT_EQ(fault_of(gltf_nodes(R"({"nodes":[{"children":[1]},{"children":[2]},{"children":[1]}]})")),
            "node '1' is a part of itself");
  EXPECT_EQ(fault_of(collada_nodes("<node id=\"a\"><instance_node url=\"#a\"/></node>")),
            "node 'a' is a part of itself");
}

TEST(NodeGraph, DeeperThanAStackIsRefused) {
  const std::string too_deep = "its nodes are more than 1000 deep";
  EXPECT_EQ(fault_of(gltf_nodes(gltf_chain(200'000, 1))), too_deep);
  std::string nested;
  for (int i = 0; i < 200'000; ++i) nested += "<node>";
  EXPECT_EQ(fault_of(collada_nodes(nested)), too_deep);
}

TEST(NodeGraph, TheReaderOfMeshesLooksFirst) {
  std::string folder = (fs::temp_directory_path() / "lab_nodes_XXXXXX").string();
  ASSERT_NE(mkdtemp(folder.data()), nullptr);
  for (const auto& [name, text] : {std::pair{"m.gltf", gltf_chain(60, 2)},
                                   {"m.glb", glb(gltf_chain(60, 2))},
                                   {"m.dae", collada_chain(60, 2)}}) {
    const std::string path = folder + "/" + name;
    std::ofstream(path, std::ios::binary) << text;
    try {
      read_mesh_file(path);
      ADD_FAILURE() << name << " was read";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(
          std::string(error.what()),
          path +
              ": cannot read mesh: its nodes name each other so often that it has more than 100000 of them");
    }
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace lab::render
