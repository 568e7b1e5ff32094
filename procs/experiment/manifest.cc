#include "procs/experiment/manifest.h"

#include <fcntl.h>
#include <lcm/lcm.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <Eigen/Core>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "procs/experiment/experiment_yaml.h"
#include "procs/experiment/hash.h"
#include "procs/experiment/robot.h"

namespace lab {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::string cpu_name() {
  std::ifstream in("/proc/cpuinfo");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
  return "unknown";
}

std::string os_name() {
  std::ifstream in("/etc/os-release");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("PRETTY_NAME=")) return line.substr(13, line.size() - 14);
  return "unknown";
}

json first_line(const std::string& path) {
  std::ifstream in(path);
  std::string line;
  return std::getline(in, line) ? json(line) : json(nullptr);
}

json file_hash(const std::string& path) {
  return fs::exists(path) ? json(hex(hash_of_file(path))) : json(nullptr);
}

std::string version(int major, int minor, int patch) {
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(patch);
}

}  // namespace

json manifest(const std::string& dir, const Launch& launch) {
  json out;
  utsname system{};
  uname(&system);
  out["lcmlab"] = LAB_VERSION;
  out["compiler"] = std::string("g++ ") + __VERSION__;
  out["flags"] = LAB_FLAGS;
  out["libraries"] = {{"lcm", version(LCM_MAJOR_VERSION, LCM_MINOR_VERSION, LCM_MICRO_VERSION)},
                      {"eigen", version(EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION)}};
  out["host"] = system.nodename;
  out["system"] = os_name();
  out["kernel"] = system.release;
  out["cpu"] = cpu_name();
  out["cores"] = std::thread::hardware_concurrency();
  out["gl"] = first_line(dir + "/gl.txt");

  out["experiment"] = out["seed"] = out["model_hash"] = nullptr;
  try {
    const Experiment e = load_experiment(dir + "/experiment.yaml");
    out["experiment"] = e.name;
    out["seed"] = e.seed;
    out["model_hash"] = hex(load_robot(e).hash);
  } catch (const std::exception& error) {
    out["experiment_error"] = error.what();
  }
  out["hashes"] = {{"experiment.yaml", file_hash(dir + "/experiment.yaml")},
                   {"log.lcm", file_hash(dir + "/log.lcm")},
                   {"telemetry.lcm", file_hash(dir + "/telemetry.lcm")}};
  std::error_code none;
  const auto bytes = fs::file_size(dir + "/log.lcm", none);
  out["log_bytes"] = none ? json(nullptr) : json(bytes);

  std::ifstream metrics(dir + "/metrics.json");
  const json found = metrics ? json::parse(metrics, nullptr, false) : json();
  for (const char* key : {"run", "last_step", "complete", "passed"})
    out[key] = found.is_object() ? found.value(key, json()) : json();

  out["started"] = launch.started.empty() ? json(nullptr) : json(launch.started);
  out["ended"] = launch.ended.empty() ? json(nullptr) : json(launch.ended);
  out["wall_seconds"] = launch.wall_seconds > 0 ? json(launch.wall_seconds) : json(nullptr);
  out["exit_codes"] = launch.exit_codes;
  return out;
}

void write_atomically(const std::string& path, const std::string& text) {
  const std::string part = path + ".part";
  const auto refuse = [&](const char* what) {
    const std::string why = std::strerror(errno);
    unlink(part.c_str());
    throw std::runtime_error(path + ": cannot be " + what + " (" + why + ")");
  };
  const int fd = open(part.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0644);
  if (fd < 0) refuse("created");
  for (size_t done = 0; done < text.size();) {
    const ssize_t n = write(fd, text.data() + done, text.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int reason = errno;
      close(fd);
      errno = reason;
      refuse("written");
    }
    done += static_cast<size_t>(n);
  }
  if (fsync(fd) != 0 || close(fd) != 0 || rename(part.c_str(), path.c_str()) != 0) refuse("written");
}

}  // namespace lab
