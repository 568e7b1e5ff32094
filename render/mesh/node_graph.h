// The nodes of a mesh file, before a reader expands them: a short file can describe more copies than any memory holds.
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace lab::render {

class NodeGraph {
 public:
  static constexpr uint64_t kMaxNodes = 100'000;  ///< after expansion
  static constexpr uint64_t kMaxDepth = 1'000;    ///< readers go down by recursion

  /// `child` is a part of `parent`: once for each call.
  void add(const std::string& parent, const std::string& child) { children_[parent].push_back(child); }
  /// Throws std::runtime_error when a node is a part of itself, or the whole has too many nodes or is too deep.
  void check() const;

 private:
  std::map<std::string, std::vector<std::string>> children_;
};

/// The nodes of a glTF file (.gltf, or .glb with its JSON inside). Empty when the text is not JSON: its reader says why.
NodeGraph gltf_nodes(std::string_view file);

/// The nodes of a Collada file, which may be used again by <instance_node>. What is no XML is left to its reader.
NodeGraph collada_nodes(std::string_view file);

}  // namespace lab::render
