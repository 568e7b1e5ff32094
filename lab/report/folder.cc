#include "lab/report/folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/process_t.hpp>
#include <map>
#include <stdexcept>
#include <string_view>

#include "core/util/json_text.h"
#include "core/util/number.h"
#include "lab/experiment/experiment_yaml.h"
#include "wire/log/checked_log.h"
#include "wire/log/logged_messages.h"
#include "wire/protocol/loop_bins.h"
#include "wire/schema/codec.h"

namespace lab::report {
namespace {

namespace fs = std::filesystem;
constexpr size_t kPictureBytes = 1'200'000;  // of all pictures on a page

std::string bytes_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// As many as a few lines need, of a file of any size.
std::string last_bytes(const fs::path& path) {
  constexpr std::streamoff kBytes = 64 << 10;
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  in.seekg(std::max<std::streamoff>(0, static_cast<std::streamoff>(in.tellg()) - kBytes));
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string numbers(const std::vector<double>& values) {
  std::string text;
  for (double value : values) text += (text.empty() ? "" : ", ") + number(value);
  return text;
}

void read_notes(const std::string& log, double dt, Folder& out) {
  read_checked(log, [&](Channel channel, std::span<const uint8_t> data) {
    if (channel != Channel::Event && channel != Channel::Input) return;
    if (++out.note_count > kMaxNotes) return;
    if (channel == Channel::Event) {
      const auto event = decode<event_t>(data);
      out.notes.push_back(
          {static_cast<double>(event.step) * dt, event.process, event.what, event.who, event.why});
    } else {
      const auto input = decode<input_t>(data);
      const action_t& action = input.action;
      std::string why = action.key + (action.key.empty() ? "" : " ") + action.text + numbers(action.values);
      out.notes.push_back(
          {static_cast<double>(input.step) * dt, input.sender, action.verb, action.target, why});
    }
  });
}

std::vector<Loops> read_loops(const std::string& telemetry) {
  std::map<std::string, std::map<int32_t, process_t>> newest;  // by name and pid
  for_each_message(telemetry, [&](Channel channel, std::span<const uint8_t> data) {
    if (channel != Channel::Process || !is_of_type<process_t>(data)) return;
    auto message = decode<process_t>(data);
    newest[message.name][message.pid] = message;
  });
  std::vector<Loops> all;
  for (const auto& [name, starts] : newest) {
    Loops loops;
    loops.process = name;
    loops.counts.resize(kLoopBins);
    for (const auto& [pid, last] : starts) {
      for (size_t i = 0; i < last.loops.size() && i < loops.counts.size(); ++i)
        loops.counts[i] += last.loops[i];
      loops.overruns += last.overruns;
      loops.late_p50 = last.lateness_p50;
      loops.late_p99 = last.lateness_p99;
      loops.late_max = last.lateness_max;
    }
    if (std::any_of(loops.counts.begin(), loops.counts.end(), [](int64_t n) { return n > 0; }))
      all.push_back(loops);
  }
  return all;
}

/// Every picture of ours says near its beginning which run it shows (tEXt, keyword "run").
bool shows(const std::string& png, int64_t run) {
  static constexpr char kText[] = "tEXtrun";
  constexpr std::string_view kKeyword(kText, sizeof kText);  // with the 0 that ends it
  const size_t at = std::string_view(png).substr(0, 1024).find(kKeyword);
  return at == std::string::npos ||
         png.compare(at + kKeyword.size(), 16, fmt::format("{:016x}", static_cast<uint64_t>(run))) == 0;
}

/// The contact sheet, or frames at even distances, as many as are small enough.
std::vector<std::string> read_pictures(const fs::path& dir, size_t& frames) {
  std::vector<fs::path> files;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(dir / "frames", none))
    if (entry.path().extension() == ".png") files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  frames = files.size();
  std::string sheet = bytes_of(dir / "contact.png");
  if (!sheet.empty() && sheet.size() <= kPictureBytes) return {sheet};
  std::vector<std::string> strip;
  for (size_t count = std::min<size_t>(6, files.size()); count > 0; --count) {
    strip.clear();
    size_t total = 0;
    for (size_t i = 0; i < count; ++i) {
      strip.push_back(bytes_of(files[count == 1 ? files.size() - 1 : i * (files.size() - 1) / (count - 1)]));
      total += strip.back().size();
    }
    if (total <= kPictureBytes) return strip;
  }
  return {};
}

/// The last lines of a text, and of these the last letters.
std::string tail(std::string text) {
  constexpr int kLines = 12;
  constexpr size_t kBytes = 4000;
  while (text.ends_with('\n')) text.pop_back();
  size_t at = text.size();
  for (int lines = 0; lines < kLines && at != std::string::npos && at > 0; ++lines)
    at = text.rfind('\n', at - 1);
  if (at != std::string::npos && at > 0) text.erase(0, at + 1);
  if (text.size() > kBytes) text.erase(0, text.size() - kBytes);
  return text;
}

std::vector<std::pair<std::string, std::string>> read_last_lines(const fs::path& dir,
                                                                 const nlohmann::json& manifest) {
  std::vector<std::pair<std::string, std::string>> all;
  if (!manifest.is_object() || !manifest.contains("exit_codes")) return all;
  for (const auto& [name, code] : manifest["exit_codes"].items()) {
    if (code == 0 || name == "run") continue;
    std::string text = tail(last_bytes(dir / "processes" / (name + ".log")));
    all.emplace_back(name + " (exit " + json_text(code) + ")", text.empty() ? "(no output)" : text);
  }
  return all;
}

}  // namespace

Folder read_folder(const std::string& dir) {
  const fs::path root(dir);
  const std::string log = find_log(dir);
  if (!fs::exists(root / "experiment.yaml") && !fs::exists(root / "manifest.json") && !fs::exists(log))
    throw std::runtime_error(
        dir + ": is not a run folder (it has neither manifest.json nor experiment.yaml nor log.lcm)");
  Folder out;
  out.name = fs::canonical(root).filename();
  out.experiment_text = bytes_of(root / "experiment.yaml");
  out.manifest = try_parse_json(bytes_of(root / "manifest.json"));
  if (!out.manifest.is_object()) out.manifest = nullptr;
  try {
    if (!fs::exists(log))
      throw std::runtime_error(
          out.is_plain_group()
              ? "there is no log.lcm: a group of processes without an experiment"
              : "there is no log.lcm: the run ended before its first step, or is still going on");
    if (fs::file_size(log) == 0) throw std::runtime_error(fs::path(log).filename().string() + " is empty");
    out.logged = read_run(log);
    out.metrics = evaluate_logged(*out.logged);
    read_notes(log, out.logged->run.dt, out);
  } catch (const std::exception& error) {
    out.no_log = error.what();
    if (out.no_log.starts_with(log + ": "))
      out.no_log = fs::path(log).filename().string() + out.no_log.substr(log.size());
    out.logged.reset();
  }
  const auto take_from_log = [&] {
    if (out.logged) out.experiment = out.logged->experiment;
  };
  try {
    if (out.experiment_text.empty())
      take_from_log();
    else
      out.experiment = parse_experiment(out.experiment_text, out.name + "/experiment.yaml");
  } catch (const std::exception&) {
    take_from_log();  // an older or broken text: the log has what counts
  }
  if (fs::exists(root / "telemetry.lcm")) out.loops = read_loops(root / "telemetry.lcm");
  out.pictures = read_pictures(root, out.frames);
  if (out.logged)
    out.other_pictures =
        std::erase_if(out.pictures, [&](const auto& png) { return !shows(png, out.logged->id); }) > 0;
  out.last_lines = read_last_lines(root, out.manifest);
  return out;
}

}  // namespace lab::report
