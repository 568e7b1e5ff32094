#include "procs/renderer/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string_view>

#include "core/util/atomic_file.h"
#include "render/png.h"

namespace lab::renderer {
namespace {

constexpr size_t kCells = 12;  // of a contact sheet made of frames

void write_floats(const std::string& path, const std::vector<float>& values) {
  const std::string_view bytes(reinterpret_cast<const char*>(values.data()), sizeof(float) * values.size());
  if (const int error = write_and_rename(path, hidden_part(path), bytes, false).error; error != 0)
    throw std::runtime_error(path + ": cannot write depths: " + std::strerror(error));
}

/// Every picture of ours says near its beginning which run it shows.
bool is_ours(const std::filesystem::path& picture) {
  std::ifstream in(picture, std::ios::binary);
  std::string begin(1024, '\0');
  in.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  return begin.find("tEXtrun") != std::string::npos;
}

/// NNNN.png, NNNN.depth.png, .., contact.png or ghost.png
bool is_name_of_ours(const std::string& name) {
  if (name == "contact.png" || name == "ghost.png") return true;
  const size_t digits = name.find_first_not_of("0123456789");
  return digits >= 4 && digits != std::string::npos && name.ends_with(".png");
}

render::PngTexts with(render::PngTexts first, const render::PngTexts& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

}  // namespace

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

std::vector<int64_t> steps_of_film(double fps, double dt, int64_t last_step) {
  const int64_t count = std::llround(static_cast<double>(last_step) * dt * fps) + 1;
  std::vector<int64_t> steps;
  for (int64_t i = 0; i + 1 < count; ++i)
    steps.push_back(std::min<int64_t>(
        last_step, std::llround(static_cast<double>(i) / (fps * dt) + 1e-9)));  // halves go up
  steps.push_back(last_step);
  return steps;
}

void make_folder(const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw std::runtime_error(folder + ": cannot make this folder: " + error.message());
}

void check_folder(const std::string& folder) {
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (is_name_of_ours(entry.path().filename()) && !is_ours(entry.path()))
      throw std::runtime_error(entry.path().string() +
                               ": is not a picture of a run, and might be replaced; choose another folder");
}

std::string frame_path(const std::string& folder, int64_t index) {
  return fmt::format("{}/{:04}.png", folder, index);
}

FrameFolder::FrameFolder(std::string folder, render::PngTexts about)
    : folder_(std::move(folder)), about_(std::move(about)) {
  make_folder(folder_);
}

void FrameFolder::write(int64_t index, Picture picture) {
  encoder_.push([path = frame_path(folder_, index), picture = std::move(picture), about = about_] {
    render::write_png(path, picture.image, with(about, picture.texts));
  });
}

void FrameFolder::write_depth(int64_t index, const render::Measurement& seen, render::PngTexts texts) {
  texts.emplace_back("unit", "0.001 m; 0 = nothing, or beyond 65.535 m");
  encoder_.push([path = fmt::format("{}/{:04}.depth", folder_, index), w = seen.width, h = seen.height,
                 depth = seen.depth, texts = with(about_, texts)] {
    render::write_png16(path + ".png", w, h, render::quantized(depth, 0.001), texts);
    write_floats(path + ".f32", depth);
  });
}

void FrameFolder::write_ids(int64_t index, const render::Measurement& seen, render::PngTexts texts,
                            const std::vector<std::string>& links) {
  std::string names = "0 nothing";
  for (size_t i = 1; i < links.size(); ++i) names += fmt::format(", {} {}", i, links[i]);
  texts.emplace_back("links", names);
  encoder_.push([path = fmt::format("{}/{:04}.id.png", folder_, index), w = seen.width, h = seen.height,
                 id = seen.id, texts = with(about_, texts)] { render::write_png16(path, w, h, id, texts); });
}

render::Image thumbnail(const render::Image& image) {
  return image.width >= 480 ? render::shrink(image, image.width >= 1200 ? 3 : 2) : image;
}

void write_contact_sheet(const std::string& path, const std::vector<Stamped>& pictures,
                         const render::PngTexts& about) {
  std::vector<render::Image> images;
  std::vector<std::string> labels;
  for (const Stamped& each : pictures) {
    images.push_back(each.image);
    labels.push_back(fmt::format("{:.2f} s", each.time));
  }
  const int columns = images.size() > 20 ? 0 : images.size() > 6 ? 4 : 3;
  render::write_png(path, render::contact_sheet(images, labels, columns), about);
}

void write_contact_sheet_of(const std::string& path, const std::string& folder,
                            const std::vector<double>& times) {
  if (times.empty()) return;
  render::PngTexts about = render::read_png(frame_path(folder, 0)).texts;
  std::erase_if(about, [](const auto& text) { return text.first != "run" && text.first != "renderer"; });
  const size_t cells = std::min(times.size(), kCells);
  std::vector<Stamped> pictures;
  for (size_t i = 0; i < cells; ++i) {
    const size_t index = cells == 1 ? 0 : i * (times.size() - 1) / (cells - 1);
    pictures.push_back(
        {thumbnail(render::read_png(frame_path(folder, static_cast<int64_t>(index))).image), times[index]});
  }
  write_contact_sheet(path, pictures, about);
}

}  // namespace lab::renderer
