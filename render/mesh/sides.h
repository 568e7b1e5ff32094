// Finds triangles whose back is visible from outside.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace lab::render {

// In how many pixels the front and the back of a triangle are visible, in small pictures from
// all around (80 directions, 192 pixels a side, no perspective). corners: three points per triangle,
// counterclockwise seen from its front.
struct Seen {
  uint32_t front = 0, back = 0;
};
std::vector<Seen> look_from_all_around(const std::vector<Eigen::Vector3f>& points,
                                       const std::vector<uint32_t>& corners);

}  // namespace lab::render
