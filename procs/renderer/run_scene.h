// Builds the scene and the camera of each picture of a run, without OpenGL. Everything is a function of the experiment,
// the options and the remembered samples. Where the camera is placed: camera_placement.h.
#pragma once
#include <rbd/algorithm/data.h>

#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/robot.h"
#include "procs/renderer/camera_placement.h"
#include "procs/renderer/snapshot.h"
#include "render/image.h"
#include "render/scene.h"
#include "render/trace.h"

namespace lab::renderer {

/// What pictures show in addition to the experiment's renderer keys. Only for finished runs: the scales depend on all
/// remembered samples.
struct Extras {
  std::string trace_by = "time";    ///< or speed, error: what the trace's colours mean
  std::vector<std::string> arrows;  ///< velocity, force, com, frames
  std::vector<Push> pushes;
};

/// Steps between the samples of a path, from the experiment alone: every 10 ms, but at most a thousand.
int64_t sample_gap(const Experiment&);

/// One picture, ready to draw.
struct Shot {
  std::optional<int64_t> step;  ///< none: several snapshots
  double time = 0;              ///< s
  render::Scene scene;
  std::vector<render::Body> robot;  ///< alone, for measurements
  render::Camera camera;
};

/// Holds no OpenGL objects or threads: may be copied, and used after a fork.
class RunScene {
 public:
  /// Loads the meshes. Throws ExperimentError for a frame that the robot does not have, std::invalid_argument for an
  /// impossible size or view.
  RunScene(const Robot&, const Experiment&, Extras = {});

  /// Adds a sample to the path that traces and ghosts show; steps must increase, others are ignored.
  void remember(const Snapshot&);
  bool needs_samples() const { return settings_.ghost > 0 || !settings_.trace.empty(); }
  /// Call after the last remember() of a finished run: fits the camera to the run and chooses the scales of arrows.
  void finish_run();

  /// The robot at one snapshot, with its path so far, its reference and arrows, as asked for. Kinematics are computed
  /// once.
  Shot shot(const Snapshot&);
  /// The remembered path in n poses, evenly along it: all but the last one ghosts, from blue to red.
  Shot ghosts(int64_t n);
  /// Writes into the picture what its colours and arrows mean, if that needs an explanation.
  void draw_legend(render::Image&) const;

  const Experiment::Renderer& settings() const { return settings_; }
  /// Links by their number in id images: [0] is the background.
  const std::vector<std::string>& links() const { return links_; }
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  struct Sample {
    int64_t step;
    double time;  ///< s
    Eigen::VectorXd q;
    Eigen::Vector3d point;  ///< m: where the traced frame was
    double speed, error;    ///< m/s, m: of that point
  };
  struct Scale {
    double metres = 0;  ///< an arrow's length for one unit
    std::string text;
  };

  CameraPlacement place_camera(const Experiment&);
  bool shows(const char* arrows) const;
  std::vector<rbd::FrameIndex> moving_frames() const;
  void set_pose(const Snapshot&);
  std::vector<render::Body> robot_at(const Eigen::VectorXd& q);
  Eigen::Vector3d followed() const { return data_.oMf[followed_].translation(); }
  Sample sample(const Snapshot&) const;
  double trace_share(const Sample&) const;
  Eigen::Vector4f colour(const Sample&) const;
  void set_scales();
  void add_trace(const Sample& now, render::Scene&);
  void add_reference(const std::vector<render::Body>& robot, render::Scene&);
  void add_arrows(const Snapshot&, render::Scene&);
  std::vector<size_t> even_samples(const std::vector<double>& along, int64_t n) const;

  Experiment::Renderer settings_;
  Extras extras_;
  double duration_, moving_ = 0;  ///< s: of the run; of the planned motion in it, 0 = all
  rbd::Model model_;
  rbd::Data data_, reference_data_;  ///< kinematics of the current snapshot, and of its reference
  std::vector<std::string> links_{""}, warnings_;
  std::vector<render::Body> robot_;
  rbd::FrameIndex traced_ = 0, followed_ = 0;
  CameraPlacement placement_;  ///< made from the members above
  std::vector<Sample> samples_;
  Extent extent_;                       ///< of the samples
  double max_value_ = 0;                ///< speed or error: the end of the trace's colours
  double max_speed_ = 0;                ///< m/s: of the moving frames
  std::optional<render::Trace> trace_;  ///< through the first traced_samples_ samples
  size_t traced_samples_ = 0;
  Scale velocity_, force_;
};

}  // namespace lab::renderer
