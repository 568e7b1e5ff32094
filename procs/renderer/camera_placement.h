// Where the camera of a run's pictures is placed: as near as `renderer.camera` (iso, front, side, top) allows with every
// planned pose in the picture. It follows the frame `renderer.follow` and orbits with `renderer.orbit`. The geometry
// of cameras is in render/camera.h.
#pragma once
#include <vector>

#include "lab/experiment/experiment.h"
#include "render/camera.h"
#include "render/scene.h"

namespace lab::renderer {

/// The boxes around a robot in some poses.
struct Extent {
  render::Bounds world;     ///< m: as in the world
  render::Bounds followed;  ///< m: each pose shifted so that the followed frame is at home
};

class CameraPlacement {
 public:
  /// follows: whether a frame is followed; home: where it is in the first planned pose (m).
  CameraPlacement(const Experiment::Renderer&, bool follows, const Eigen::Vector3d& home);

  /// Adds one pose of the robot to an extent; followed: where the followed frame is then.
  void extend(Extent&, const std::vector<render::Body>& robot, const Eigen::Vector3d& followed) const;
  /// Places the camera to see all planned poses.
  void set_planned(const Extent&);
  /// Also sees all of a finished run, if the robot clearly left the planned volume.
  void include_run(const Extent&);

  /// The camera at a time (s); followed: where the frame is then (m). Throws std::invalid_argument for an invalid view.
  render::Camera at(double time, const Eigen::Vector3d& followed) const;
  /// Without following or orbit: for a picture of the whole run.
  const render::Camera& still() const { return still_; }
  double picture_width() const;  ///< m: at the target of the still camera

 private:
  void place();
  double aspect() const;

  const Experiment::Renderer settings_;
  bool follows_;
  Eigen::Vector3d home_;
  Extent extent_;
  render::Camera camera_, still_;  ///< camera_: for time 0 and the followed frame at home_
};

}  // namespace lab::renderer
