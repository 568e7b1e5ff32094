#include "procs/renderer/video.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "core/util/atomic_file.h"

namespace lab::renderer {
namespace {

/// Even sides and 4:2:0 with BT.709 is what every player accepts. No stamp of the time or the encoder: the same film has
/// the same bytes.
constexpr const char* kEncoding =
    "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2,scale=out_color_matrix=bt709:out_range=tv -c:v libx264 -preset "
    "veryfast -crf 18 "
    "-pix_fmt yuv420p -colorspace bt709 -color_primaries bt709 -color_trc bt709 -color_range tv -fflags "
    "+bitexact "
    "-flags:v +bitexact -movflags +faststart -f mp4";

std::vector<std::string> words(const std::string& text) {
  std::istringstream in(text);
  return {std::istream_iterator<std::string>(in), {}};
}

/// Runs a program in a folder to its end and calls on_line with every line of its output (both streams). Returns its
/// exit code; -1 with errno if it cannot be started.
int run(std::vector<std::string> words, const std::string& folder,
        const std::function<void(const std::string&)>& on_line) {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return -1;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_adddup2(&files, ends[1], STDERR_FILENO);
  posix_spawn_file_actions_addchdir_np(&files, folder.c_str());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t pid = 0;
  const int error = posix_spawnp(&pid, argv[0], &files, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  close(ends[1]);
  std::FILE* output = fdopen(ends[0], "r");
  char line[1024];
  while (error == 0 && std::fgets(line, sizeof line, output)) {
    line[std::strcspn(line, "\r\n")] = '\0';
    on_line(line);
  }
  std::fclose(output);
  if (error != 0) {
    errno = error;
    return -1;
  }
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

}  // namespace

void need_ffmpeg() {
  if (run({"ffmpeg", "-version"}, ".", [](const std::string&) {}) != 0)
    throw std::runtime_error(
        "--video needs ffmpeg, which is not here: apt-get install ffmpeg (pictures work without it)");
}

void write_video(const std::string& path, const std::string& folder, int64_t count, double fps,
                 const std::string& title, const std::function<void(int64_t done)>& progress) {
  // ffmpeg runs in the pictures' folder
  const std::string part = hidden_part(std::filesystem::absolute(path).string());
  std::vector<std::string> command = words(fmt::format(
      "ffmpeg -nostdin -y -loglevel error -progress pipe:1 -nostats -framerate {} -start_number 0 "
      "-i %04d.png -frames:v {} {}",
      fps, count, kEncoding));
  command.insert(command.end(), {"-metadata", "title=" + title, part});
  std::string complaint;
  const int code = run(std::move(command), folder, [&](const std::string& line) {
    const auto equal = line.find('=');
    if (line.starts_with("frame="))
      progress(std::strtoll(line.c_str() + 6, nullptr, 10));
    else if (equal == std::string::npos || line.find(' ') < equal)
      complaint = line;  // not of -progress
  });
  if (code == 0 && std::rename(part.c_str(), path.c_str()) == 0) return;
  if (complaint.empty())
    complaint =
        code < 0 || code == 0 ? std::strerror(errno) : fmt::format("ffmpeg ended with exit code {}", code);
  std::remove(part.c_str());
  throw std::runtime_error(path + ": cannot write the video: " + complaint);
}

}  // namespace lab::renderer
