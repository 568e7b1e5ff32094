#include "render/mesh/node_graph.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "core/util/json_text.h"

namespace lab::render {
namespace {

struct Size {
  uint64_t nodes = 1, depth = 1;  // after expansion, of a node with all that is below it
};

/// The JSON part of a .glb: behind a header of 12 bytes, length (little-endian), type "JSON", text.
std::string_view json_of(std::string_view file) {
  if (file.substr(0, 4) != "glTF" || file.size() < 20) return file;
  uint32_t length = 0;
  for (int i = 3; i >= 0; --i) length = length << 8 | static_cast<uint8_t>(file[12 + i]);
  return file.substr(20, length);
}

/// The value of an attribute inside a tag; empty without it.
std::string attribute(std::string_view tag, std::string_view name) {
  for (size_t at = tag.find(name); at != tag.npos; at = tag.find(name, at + 1)) {
    const size_t quote = tag.find_first_not_of(" \t\r\n=", at + name.size());
    if (at == 0 || !std::isspace(static_cast<unsigned char>(tag[at - 1])) || quote == tag.npos) continue;
    if (tag[quote] != '"' && tag[quote] != '\'') continue;
    return std::string(tag.substr(quote + 1, tag.find(tag[quote], quote + 1) - quote - 1));
  }
  return {};
}

bool is_tag(std::string_view tag, std::string_view name) {
  return tag.starts_with(name) &&
         (tag.size() == name.size() || !std::isalnum(static_cast<unsigned char>(tag[name.size()]))) &&
         !tag.substr(name.size()).starts_with('_');
}

}  // namespace

void NodeGraph::check() const {
  std::map<std::string, Size> done;
  std::set<std::string> open;  // from the root to the node in hand
  std::vector<std::pair<std::string, size_t>> way;
  uint64_t all = 0;
  static const std::vector<std::string> kNone;
  const auto parts_of = [&](const std::string& node) -> const std::vector<std::string>& {
    const auto found = children_.find(node);
    return found == children_.end() ? kNone : found->second;
  };
  const auto enter = [&](const std::string& node) {
    if (!open.insert(node).second) throw std::runtime_error("node '" + node + "' is a part of itself");
    way.emplace_back(node, 0);
  };
  for (const auto& [root, parts] : children_) {
    if (!done.contains(root)) enter(root);
    while (!way.empty()) {
      auto& [node, next] = way.back();
      const auto& below = parts_of(node);
      if (next < below.size()) {
        const std::string& child = below[next++];
        if (!done.contains(child)) enter(child);
        continue;
      }
      Size size;
      for (const std::string& child : below) {
        size.nodes = std::min(kMaxNodes + 1, size.nodes + done[child].nodes);
        size.depth = std::max(size.depth, 1 + done[child].depth);
      }
      if (size.depth > kMaxDepth)
        throw std::runtime_error("its nodes are more than " + std::to_string(kMaxDepth) + " deep");
      open.erase(node);
      done[node] = size;
      way.pop_back();
    }
    all = std::max(all, done[root].nodes);
  }
  if (all > kMaxNodes)
    throw std::runtime_error("its nodes name each other so often that it has more than " +
                             std::to_string(kMaxNodes) + " of them");
}

NodeGraph gltf_nodes(std::string_view file) {
  NodeGraph graph;
  const nlohmann::json all = try_parse_json(json_of(file));
  const auto add_all = [&](const char* list, const char* of_each, const std::string& prefix) {
    if (!all.is_object() || !all.contains(list) || !all[list].is_array()) return;
    for (size_t i = 0; i < all[list].size(); ++i) {
      const nlohmann::json& one = all[list][i];
      if (!one.is_object() || !one.contains(of_each) || !one[of_each].is_array()) continue;
      for (const nlohmann::json& part : one[of_each])
        if (part.is_number_integer())
          graph.add(prefix + std::to_string(i), std::to_string(part.get<int64_t>()));
    }
  };
  add_all("scenes", "nodes", "scene ");
  add_all("nodes", "children", "");
  return graph;
}

NodeGraph collada_nodes(std::string_view file) {
  NodeGraph graph;
  std::vector<std::string> inside{"the scene"};
  uint64_t nameless = 0;
  for (size_t at = file.find('<'); at != file.npos; at = file.find('<', at + 1)) {
    const std::string_view tag = file.substr(at + 1, std::min(file.find('>', at), file.size()) - at - 1);
    if (is_tag(tag, "node")) {
      std::string id = attribute(tag, "id");
      if (id.empty()) id = "nameless " + std::to_string(++nameless);
      graph.add(inside.back(), id);
      if (!tag.ends_with('/')) inside.push_back(id);
    } else if (is_tag(tag, "/node")) {
      if (inside.size() > 1) inside.pop_back();
    } else if (is_tag(tag, "instance_node")) {
      if (const std::string url = attribute(tag, "url"); url.starts_with('#'))
        graph.add(inside.back(), url.substr(1));
    }
  }
  return graph;
}

}  // namespace lab::render
