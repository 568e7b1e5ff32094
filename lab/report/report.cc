#include "lab/report/report.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/util/exit_code.h"
#include "core/util/json_text.h"
#include "core/util/number.h"
#include "lab/page/page.h"
#include "lab/page/template.h"
#include "lab/report/charts.h"
#include "lab/report/tables.h"

namespace lab::report {
namespace {

using nlohmann::json;
using page::figure;

json note_rows(const std::vector<Note>& notes) {
  json rows = json::array();
  for (const Note& note : notes)
    rows.push_back({{"time", figure(note.time, 6)},
                    {"by", note.who},
                    {"what", note.what},
                    {"about", note.about},
                    {"why", note.why}});
  return rows;
}

json loop_rows(const std::vector<Loops>& all) {
  json rows = json::array();
  for (const Loops& loops : all)
    rows.push_back({{"process", loops.process},
                    {"count", std::accumulate(loops.counts.begin(), loops.counts.end(), int64_t{0})},
                    {"p50", loop_quantile(loops, 0.5)},
                    {"p99", loop_quantile(loops, 0.99)},
                    {"p999", loop_quantile(loops, 0.999)},
                    {"overruns", loops.overruns},
                    {"lateness", loops.late_max > 0 ? figure(loops.late_p50) + ", " + figure(loops.late_p99) +
                                                          ", " + figure(loops.late_max, 6)
                                                    : "–"}});
  return rows;
}

json version_rows(const json& manifest) {
  json rows = json::array();
  if (manifest.is_null()) return rows;
  const auto add = [&](const std::string& label, const json& what) {
    if (!what.is_null())
      rows.push_back(
          {{"label", label}, {"value", what.is_string() ? what.get<std::string>() : json_text(what)}});
  };
  for (const auto& [key, label] : {std::pair("lcmlab", "lcmlab"),
                                   {"compiler", "compiler"},
                                   {"flags", "flags"},
                                   {"system", "system"},
                                   {"kernel", "kernel"},
                                   {"cpu", "CPU"},
                                   {"cores", "cores"},
                                   {"gl", "pictures by"},
                                   {"host", "host"},
                                   {"started", "started"},
                                   {"ended", "ended"},
                                   {"wall_seconds", "wall time (s)"},
                                   {"seed", "seed"},
                                   {"run", "run"},
                                   {"model_hash", "model hash"}})
    add(label, manifest.value(key, json()));
  const json libraries = manifest.value("libraries", json::object());
  for (const auto& [name, version] : libraries.items()) add(name, version);
  const json hashes = manifest.value("hashes", json::object());
  for (const auto& [name, hash] : hashes.items()) add("hash of " + name, hash);
  const json exit_codes = manifest.value("exit_codes", json::object());
  std::string codes;
  for (const auto& [name, code] : exit_codes.items())
    codes += (codes.empty() ? "" : ", ") + name + " " + json_text(code);
  if (manifest.contains("exit_codes")) add("exit codes", codes);
  return rows;
}

/// What the page says of the motion; null if the log has no whole step.
json motion_values(const Folder& folder) {
  if (!folder.logged || folder.logged->run.steps.empty()) return nullptr;
  const Run& run = folder.logged->run;
  const json& m = folder.metrics;
  return {{"key_figures", key_figures(m, run.model)},
          {"has_verdicts", !m["verdicts"].empty()},
          {"verdicts", verdict_rows(m, run.model)},
          {"tracking", drawn(tracking_charts(run))},
          {"band", band_in_words(number_in(m, "band"), run.model)},
          {"within_band", number_in(m, "max_error") <= number_in(m, "band")},
          {"error", drawn(error_charts(run))},
          {"joint_tables", joint_tables(m, run.model)},
          {"has_reaches", !m["reaches"].empty()},
          {"reaches", reach_rows(m, run.model)},
          {"effort", drawn(effort_charts(run))},
          {"tool_frame", m["tool_frame"]},
          {"tool", drawn(tool_charts(run))},
          {"energy", drawn(energy_charts(run))},
          {"metrics", metric_rows(m, run.model)}};
}

/// Why there is no motion on the page; null if there is.
json no_motion(const Folder& folder) {
  if (!folder.logged) return folder.no_log;
  if (folder.logged->run.steps.empty()) return "the log has no whole step";
  return nullptr;
}

json last_lines(const Folder& folder) {
  json out = json::array();
  for (const auto& [process, text] : folder.last_lines) out.push_back({{"process", process}, {"text", text}});
  return out;
}

/// Null if nothing is wrong with the log.
json damage(const Folder& folder) {
  if (!folder.logged || folder.logged->log.sound()) return nullptr;
  std::string places;
  for (const std::string& line : lines_of(folder.logged->log, 20)) places += line + "\n";
  return json{{"places", places}, {"has_steps", !folder.logged->run.steps.empty()}};
}

}  // namespace

json badge_of(const Folder& folder) {
  const auto badge = [](const std::string& text, bool good) { return json{{"text", text}, {"good", good}}; };
  const json codes =
      folder.manifest.is_object() ? folder.manifest.value("exit_codes", json::object()) : json::object();
  const int code = codes.contains("run") && codes["run"].is_number_integer() ? codes["run"].get<int>() : 0;
  if (code == 124) return badge("timed out", false);
  if (was_stopped(code)) return badge("stopped", false);
  if (code > 1) return badge("ended with exit " + std::to_string(code), false);
  if (!folder.logged) return badge("no log", false);
  if (!folder.logged->log.sound()) return badge("damaged log", false);
  if (folder.logged->growing) return badge("goes on", true);
  if (!folder.metrics["complete"].get<bool>()) return badge("incomplete", false);
  if (folder.metrics["verdicts"].empty()) return badge("complete", true);
  const bool passed = folder.metrics["passed"].get<bool>();
  return badge(passed ? "as expected" : "not as expected", passed);
}

/// How long the run was to last, or did, if it was to go on until it was ended.
std::string lasted(const Experiment& e, const json& metrics) {
  if (!e.runs_until_ended()) return number(e.simulator.duration) + " s";
  if (!metrics.contains("last_step")) return "until it is ended,";
  return number(std::max(metrics["last_step"].get<double>(), 0.0) * e.simulator.dt) + " s";
}

std::string about(const Folder& folder) {
  if (!folder.experiment) return "";
  const Experiment& e = *folder.experiment;
  std::string out;
  if (folder.logged)
    out += folder.logged->robot.model.name + ", " +
           std::to_string(joints_of(folder.logged->run.model).size()) + " joints · ";
  out += e.planner.kind + " · " + e.controller.kind + " · " + lasted(e, folder.metrics) + " in steps of " +
         number(e.simulator.dt) + " s · " + e.simulator.clock;
  return out;
}

std::string run_page(const Folder& folder) {
  const std::string name = folder.experiment ? folder.experiment->name : folder.name;
  const json& m = folder.metrics;
  json pictures = json::array();
  for (const std::string& png : folder.pictures) pictures.push_back(page::base64(png));
  json values{{"name", name},
              {"badge", badge_of(folder)},
              {"about", about(folder)},
              {"no_motion", no_motion(folder)},
              {"damage", damage(folder)},
              {"incomplete", nullptr},
              {"so_far", nullptr},
              {"last_lines", last_lines(folder)},
              {"motion", motion_values(folder)},
              {"has_pictures", !pictures.empty()},
              {"pictures", std::move(pictures)},
              {"frames", folder.frames > 0},
              {"other_pictures", folder.other_pictures},
              {"has_log", folder.logged.has_value()},
              {"has_notes", !folder.notes.empty()},
              {"notes", note_rows(folder.notes)},
              {"more_notes", nullptr},
              {"loops", nullptr},
              {"has_versions", folder.manifest.is_object()},
              {"versions", version_rows(folder.manifest)},
              {"experiment", folder.experiment_text}};
  if (!values["motion"].is_null() && folder.logged && folder.logged->growing)
    values["so_far"] = {{"seconds", number(m["last_step"].get<double>() * m["dt"].get<double>())}};
  else if (!values["motion"].is_null() && !m["complete"].get<bool>())
    values["incomplete"] = {
        {"last_step", m["last_step"]}, {"wanted_last_step", m["wanted_last_step"]}, {"reason", m["reason"]}};
  if (folder.note_count > folder.notes.size())
    values["more_notes"] = std::to_string(folder.note_count - folder.notes.size());
  if (!folder.loops.empty())
    values["loops"] = {{"charts", drawn(loop_charts(folder.loops))}, {"processes", loop_rows(folder.loops)}};
  return page::document(name, page::fill(embedded(), "run.html", values));
}

}  // namespace lab::report
