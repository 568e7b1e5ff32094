// The frames of a robot as a tree, as text and as JSON.
#pragma once
#include <rbd/model/model.h>

#include <nlohmann/json.hpp>
#include <string>

namespace lab::model {

/// All frames as a tree, one line each: joints with their kind, links with their mass (kg), other frames with
/// their type. A link that stands where its joint stands shares the joint's line: "elbow RY > forearm 1.2
/// kg".
std::string tree_text(const rbd::Model&);

/// {"name", "type", "kind" of joints, "mass" of links, "children": [..]}, from the universe down.
nlohmann::ordered_json tree_json(const rbd::Model&);

}  // namespace lab::model
