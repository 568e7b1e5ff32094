// Finds triangles whose back is visible from outside.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace lab::render {

// How often a triangle is in front of all others, with its front and with its back, in small pictures from
// all around (80 directions, 192 pixels a side, no perspective). corners: three points per triangle,
// counterclockwise seen from its front.
struct Seen {
  uint32_t front = 0, back = 0;
};
std::vector<Seen> look_from_all_around(const std::vector<Eigen::Vector3f>& points,
                                       const std::vector<uint32_t>& corners);

}  // namespace lab::render
