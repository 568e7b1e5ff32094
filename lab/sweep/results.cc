#include "lab/sweep/results.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "core/util/json_text.h"
#include "lab/evaluation/evaluate.h"

namespace lab::sweep {

namespace fs = std::filesystem;
using nlohmann::json;

std::string result_line(const std::string& key, const json& evaluated) {
  json values = json::object();
  for (const Metric& metric : metrics()) {
    values[metric.name] = evaluated.value(metric.name, json());
    for (const json& joint : evaluated["joints"])
      if (metric.per_joint)
        values[metric.name + ("." + joint["name"].get<std::string>())] = joint.value(metric.name, json());
  }
  const json line{{"key", key},
                  {"last_step", evaluated["last_step"]},
                  {"complete", evaluated["complete"]},
                  {"passed", evaluated["passed"]},
                  {"reason", evaluated["reason"]},
                  {"metrics", std::move(values)}};
  return json_text(line) + "\n";
}

Results::Results(std::string dir, std::vector<std::string> metrics)
    : dir_(std::move(dir)), metrics_(std::move(metrics)) {}

std::optional<Row> Results::read(const std::string& line) const {
  try {
    const json all = parse_json(line);
    Row row;
    row.state = Row::State::Done;
    row.key = all.at("key").get<std::string>();
    row.last_step = all.at("last_step").get<int64_t>();
    row.complete = all.at("complete").get<bool>();
    row.passed = all.at("passed").get<bool>();
    row.reason = all.at("reason").get<std::string>();
    for (const std::string& name : metrics_) {
      if (!row.complete) break;  // figures of a part of a run cannot be compared
      const json value = all.at("metrics").value(name, json());
      row.metrics.push_back(value.is_number() ? value.get<double>() : NAN);
    }
    return row;
  } catch (const json::exception&) {
    return std::nullopt;
  }
}

void Results::load() {
  std::error_code none;
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(dir_, none))
    if (entry.path().extension() == ".jsonl") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  const std::lock_guard guard(lock_);
  for (const fs::path& file : files) {
    std::ifstream in(file, std::ios::binary);
    std::streamoff& known = read_to_[file];
    in.seekg(known);
    for (std::string line; std::getline(in, line) && !in.eof(); known = in.tellg())
      if (std::optional<Row> row = read(line)) rows_.insert_or_assign(row->key, std::move(*row));
  }
}

bool Results::are_in(const std::string& dir) {
  std::error_code none;
  if (fs::is_directory(dir, none) && fs::is_empty(dir, none)) return true;
  std::ifstream in(dir + "/0000.jsonl", std::ios::binary);
  std::string line;  // one that was cut off at once is empty
  return in && (!std::getline(in, line) || line.starts_with("{\"complete\":"));
}

std::optional<Row> Results::find(const std::string& key) const {
  const std::lock_guard guard(lock_);
  const auto row = rows_.find(key);
  return row == rows_.end() ? std::nullopt : std::optional<Row>(row->second);
}

size_t Results::size() const {
  const std::lock_guard guard(lock_);
  return rows_.size();
}

/// Takes the first free number: every process has a file of its own.
void Results::open() {
  fs::create_directories(dir_);
  for (int n = 0; descriptor_ < 0; ++n) {
    file_ = fmt::format("{}/{:04}.jsonl", dir_, n);
    descriptor_ = ::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST)
      throw std::runtime_error(file_ + ": cannot be created (" + std::strerror(errno) + ")");
  }
}

Row Results::add(const std::string& line) {
  std::optional<Row> found = read(line);
  if (!found) throw std::invalid_argument(dir_ + ": not the line of a run: " + line);
  Row row = std::move(*found);
  const std::lock_guard guard(lock_);
  if (descriptor_ < 0) open();
  if (const ssize_t n = ::write(descriptor_, line.data(), line.size());
      n != static_cast<ssize_t>(line.size()))
    throw std::runtime_error(file_ + ": cannot be written (" + (n < 0 ? std::strerror(errno) : "disk full?") +
                             ")");
  rows_.insert_or_assign(row.key, row);
  return row;
}

}  // namespace lab::sweep
