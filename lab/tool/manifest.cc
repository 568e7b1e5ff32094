#include "lab/tool/manifest.h"

#include <lcm/lcm.h>
#include <sys/utsname.h>

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/util/json_text.h"
#include "core/util/version.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/hash.h"
#include "lab/experiment/robot.h"

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

json object_in(const std::string& path) {
  std::ifstream in(path);
  json found = in ? try_parse_json(std::string(std::istreambuf_iterator<char>(in), {})) : json();
  return found.is_object() ? found : json();
}

json member(const json& object, const char* key) {
  return object.is_object() ? object.value(key, json()) : json();
}

json manifest(const std::string& dir, const Launch& launch) {
  json out;
  utsname system{};
  uname(&system);
  out["lcmlab"] = kVersion;
  out["commit"] = commit();
  out["state"] = "ended";
  out["files"] =
      member(object_in(dir + "/manifest.json"), "files");  // as the verb that began the run wrote them
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

  const json metrics = object_in(dir + "/metrics.json");
  for (const char* key : {"run", "last_step", "complete", "passed"}) out[key] = member(metrics, key);

  out["started"] = launch.started.empty() ? json(nullptr) : json(launch.started);
  out["ended"] = launch.ended.empty() ? json(nullptr) : json(launch.ended);
  out["wall_seconds"] = launch.wall_seconds > 0 ? json(launch.wall_seconds) : json(nullptr);
  out["exit_codes"] = launch.exit_codes;
  return out;
}

}  // namespace lab
