#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "render/image.h"

namespace lab::renderer {

/// The steps to draw for `fps` pictures per second of simulation time, first and last step included.
std::vector<int64_t> steps_at_rate(double fps, double dt, int64_t last_step);

/// Writes numbered pictures into a folder and, at the end, the contact sheet beside it.
class FrameFolder {
 public:
  /// Makes `folder` if it is not there. `about` is written into every picture (tEXt): run, camera, renderer.
  FrameFolder(std::string folder, std::vector<std::pair<std::string, std::string>> about);
  /// Writes NNNN.png and remembers it for the contact sheet. Returns its path.
  std::string write(const render::Image& image, int64_t step, double time);
  /// Up to twelve pictures, evenly chosen, with their times. Does nothing if none was written.
  void write_contact_sheet(const std::string& path) const;
  int64_t count() const { return static_cast<int64_t>(files_.size()); }

 private:
  struct File {
    std::string path;
    double time;
  };
  std::string folder_;
  std::vector<std::pair<std::string, std::string>> about_;
  std::vector<File> files_;
};

}  // namespace lab::renderer
