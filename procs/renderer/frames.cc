#include "procs/renderer/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "render/png.h"

namespace lab::renderer {

std::vector<int64_t> steps_at_rate(double fps, double dt, int64_t last_step) {
  std::vector<int64_t> steps;
  for (int64_t i = 0;; ++i) {
    const int64_t step = std::llround(static_cast<double>(i) / fps / dt);
    if (step > last_step) break;
    if (steps.empty() || step > steps.back()) steps.push_back(step);
  }
  if (steps.back() != last_step) steps.push_back(last_step);
  return steps;
}

FrameFolder::FrameFolder(std::string folder, std::vector<std::pair<std::string, std::string>> about)
    : folder_(std::move(folder)), about_(std::move(about)) {
  std::filesystem::create_directories(folder_);
}

std::string FrameFolder::write(const render::Image& image, int64_t step, double time) {
  const std::string path = fmt::format("{}/{:04}.png", folder_, files_.size());
  render::PngTexts texts = about_;
  texts.emplace_back("step", std::to_string(step));
  texts.emplace_back("time", fmt::format("{:.6f} s", time));
  render::write_png(path, image, texts);
  files_.push_back({path, time});
  return path;
}

void FrameFolder::write_contact_sheet(const std::string& path) const {
  if (files_.empty()) return;
  const size_t cells = std::min<size_t>(files_.size(), 12);
  std::vector<render::Image> images;
  std::vector<std::string> labels;
  for (size_t i = 0; i < cells; ++i) {
    const File& file = files_[cells == 1 ? 0 : i * (files_.size() - 1) / (cells - 1)];
    const render::Image image = render::read_png(file.path).image;
    images.push_back(image.width >= 480 ? render::shrink(image, 2) : image);
    labels.push_back(fmt::format("{:.2f} s", file.time));
  }
  render::write_png(path, render::contact_sheet(images, labels, cells > 6 ? 4 : 3), about_);
}

}  // namespace lab::renderer
