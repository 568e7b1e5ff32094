// Numbered pictures in a folder, and contact sheets of them.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "procs/renderer/encoder.h"
#include "procs/renderer/painter.h"

namespace lab::renderer {

/// The steps to draw for `fps` pictures per second of simulation time, first and last step included.
std::vector<int64_t> steps_at_rate(double fps, double dt, int64_t last_step);

/// The step of each picture of a film that lasts as long as the run: one for every 1/fps from the first step to the last, both
/// included. Where a step takes longer than a picture, several show the same.
std::vector<int64_t> steps_of_film(double fps, double dt, int64_t last_step);

/// Makes a folder if it is not there, and those above it. Throws std::runtime_error with path and reason.
void make_folder(const std::string& folder);

/// Throws std::runtime_error if the folder has a file that pictures of a run might replace, and that is none.
void check_folder(const std::string& folder);

/// FOLDER/NNNN.png
std::string frame_path(const std::string& folder, int64_t index);

/// Writes numbered pictures into a folder, on a separate thread. Its calls throw the error of an earlier
/// picture.
class FrameFolder {
 public:
  /// Makes `folder`. `about` is written into every file (tEXt): run, renderer.
  FrameFolder(std::string folder, render::PngTexts about);

  void write(int64_t index, Picture picture);
  /// NNNN.depth.png (16 bits, mm, 0 = nothing) and NNNN.depth.f32 (m, float32 in native byte order, rows from the top,
  /// infinity = nothing).
  void write_depth(int64_t index, const render::Measurement&, render::PngTexts);
  /// NNNN.id.png: 16 bits, the link's number; its texts list the links.
  void write_ids(int64_t index, const render::Measurement&, render::PngTexts,
                 const std::vector<std::string>& links);

  int64_t done() { return encoder_.done(); }  ///< files written
  void finish() { encoder_.finish(); }        ///< waits for all

 private:
  std::string folder_;
  render::PngTexts about_;
  Encoder encoder_;
};

/// A picture for a contact sheet.
struct Stamped {
  render::Image image;
  double time;
};
/// Pictures with their times below.
void write_contact_sheet(const std::string& path, const std::vector<Stamped>&, const render::PngTexts& about);

/// The size at which a picture goes into a contact sheet.
render::Image thumbnail(const render::Image&);

/// Up to twelve of the first `count` frames of a folder, evenly chosen, as a contact sheet with the
/// same text for the run. Nothing if there are none.
void write_contact_sheet_of(const std::string& path, const std::string& folder,
                            const std::vector<double>& times);

}  // namespace lab::renderer
