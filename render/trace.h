// The path of a point as a tube, an annotation as those of markers.h: all at once, or growing point by point.
#pragma once

#include <optional>
#include <vector>

#include "render/scene.h"

namespace lab::render {

// A tube that grows at its end. Every `piece_rings` points a piece of it is finished: a mesh that never changes again and
// is uploaded once, so that a film with a trace costs the same for each picture, however long the trace is. Copies share
// finished pieces.
class Trace {
 public:
  static constexpr size_t kPieceRings = 64;

  // Throws std::invalid_argument for a radius (m) that is not positive. piece_rings 0: one mesh, whatever its length.
  explicit Trace(double radius, size_t piece_rings = kPieceRings);

  // The colour (sRGB) runs from point to point. A point closer to the one before than 1/20 of the radius is skipped.
  // Throws std::invalid_argument for a non-finite point.
  void add(const Eigen::Vector3d& point, const Eigen::Vector4f& colour);
  // One part for each piece; none as long as there are fewer than two different points.
  Body body() const;

 private:
  struct Point {
    Eigen::Vector3d at;
    Eigen::Vector4f colour;
  };

  void add_ring(const Eigen::Vector3d& centre, const Eigen::Vector3d& lean, double radius,
                const Eigen::Vector4f& colour);
  void add_cap(const Point& point, const Eigen::Vector3d& outwards, bool start);
  void add_point_rings(const Point& point, const Eigen::Vector3d& from);
  void start_next_piece();

  double radius_;
  size_t piece_rings_;
  std::vector<MeshPtr> pieces_;
  Mesh open_;                                // the piece at the end
  std::optional<Point> last_;                // its rings are added when the next point is known
  bool first_ = true;                        // whether last_ is the first point
  Eigen::Vector3d into_{0, 0, 0};            // direction towards last_; 0 at the first point
  Eigen::Vector3d x_{0, 0, 0}, y_{0, 0, 0};  // axes of a ring, transported without twist
};

// A trace through all points as one mesh: one colour for each point, or one for all. Throws as Trace does, and
// std::invalid_argument for any other number of colours. A radius of 0.004 times the picture's width (m) looks good.
Body make_trace(const std::vector<Eigen::Vector3d>& points, const std::vector<Eigen::Vector4f>& colours,
                double radius);

}  // namespace lab::render
