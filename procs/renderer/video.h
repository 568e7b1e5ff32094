// Films: numbered pictures into one H.264 file, by ffmpeg.
#pragma once
#include <cstdint>
#include <functional>
#include <string>

namespace lab::renderer {

/// Throws std::runtime_error with one line that says how to install ffmpeg if it is missing.
void need_ffmpeg();

/// FOLDER/0000.png and on, `count` pictures, as an H.264 film. The file gets its final name only when it is complete.
/// Throws std::runtime_error with ffmpeg's message.
void write_video(const std::string& path, const std::string& folder, int64_t count, double fps,
                 const std::string& title, const std::function<void(int64_t done)>& progress);

}  // namespace lab::renderer
