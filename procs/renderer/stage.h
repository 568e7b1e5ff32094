#pragma once
#include <rbd/algorithm/data.h>

#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/robot.h"
#include "render/camera.h"
#include "render/image.h"
#include "render/scene.h"

namespace lab::renderer {

/// What pictures need of a step.
struct Moment {
  int64_t step = 0;
  double time = 0;         ///< s
  Eigen::VectorXd q, v;    ///< v may be empty
  Eigen::VectorXd wanted;  ///< q of the reference for this step; empty if there is none
};

/// A force on a frame's origin, for some time.
struct Push {
  double begin = 0, end = 0;  ///< s
  std::string frame;
  Eigen::Vector3d force;  ///< N, world axes
};

/// What pictures show besides what the experiment's renderer keys say. Only for finished runs: scales are made from all
/// that is remembered.
struct Extras {
  std::string trace_by = "time";    ///< or speed, error: what the trace's colours mean
  std::vector<std::string> arrows;  ///< velocity, force, com, frames
  std::vector<Push> pushes;
};

/// Steps between the samples of a way, from the experiment alone: every 10 ms, but at most a thousand.
int64_t sample_gap(const Experiment&);

/// The robot of a run as scenes before a camera: all of a picture but OpenGL. Everything is a function of experiment,
/// extras and what was remembered. Plain memory: may be copied, and be forked.
class Stage {
 public:
  /// Loads the meshes. Throws ExperimentError for a frame that the robot has not, std::invalid_argument for a size or
  /// view that cannot be.
  Stage(const Robot&, const Experiment&, Extras = {});

  /// Adds a sample to the way that traces and ghosts show; steps must rise, others are left out.
  void remember(const Moment&);
  bool needs_samples() const { return settings_.ghost > 0 || !settings_.trace.empty(); }
  /// Of a finished run, when all is remembered: lets the camera see it, where the run went clearly beyond what the plan
  /// let expect, and chooses the scales of arrows.
  void frame_all();

  /// The robot at one moment, with its way so far, its reference and arrows, as asked for.
  render::Scene scene(const Moment&);
  render::Scene robot_alone(const Moment&);
  render::Camera camera(const Moment&);
  /// The remembered way in n poses, evenly along it: all but the last one ghosts, from blue to red.
  render::Scene ghosts(int64_t n);
  const render::Camera& ghost_camera() const { return still_camera_; }
  /// Writes into the picture what its colours and arrows mean, if that wants saying.
  void draw_legend(render::Image&) const;

  const Experiment::Renderer& settings() const { return settings_; }
  /// Links by their number in id images: [0] is the background.
  const std::vector<std::string>& links() const { return links_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Sample {
    Moment moment;
    Eigen::Vector3d point;  ///< m: where the traced frame was
    double speed, error;    ///< m/s, m: of that point
  };
  struct Scale {
    double metres = 0;  ///< an arrow's length for one unit
    std::string text;
  };

  bool shows(const char* arrows) const;
  std::vector<rbd::FrameIndex> moving_frames() const;
  std::vector<render::Body> robot_at(const Eigen::VectorXd& q);
  Sample sample(const Moment&);
  void set_cameras();
  void extend(const Eigen::VectorXd& q, render::Bounds& world, render::Bounds& followed);
  double width() const;  ///< m: of the picture, at what the camera looks at
  double share(const Sample&) const;
  Eigen::Vector4f colour(const Sample&) const;
  void set_scales();
  void add_trace(const std::vector<Sample>&, const std::vector<Eigen::Vector4f>&, render::Scene&) const;
  void add_arrows(const Moment&, render::Scene&);

  Experiment::Renderer settings_;
  Extras extras_;
  double duration_, moving_ = 0;  ///< s: of the run; of the planned motion in it, 0 = all
  rbd::Model model_;
  rbd::Data data_;
  std::vector<std::string> links_{""}, warnings_;
  std::vector<render::Body> robot_;
  rbd::FrameIndex traced_ = 0, followed_ = 0;
  Eigen::Vector3d home_ = Eigen::Vector3d::Zero();  ///< of the followed frame, for which camera_ stands
  render::Bounds box_, followed_box_;
  render::Camera camera_, still_camera_;
  std::vector<Sample> way_;
  double most_ = 0;  ///< speed or error: the end of the trace's colours
  Scale velocity_, force_;
};

}  // namespace lab::renderer
