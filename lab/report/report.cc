#include "lab/report/report.h"

#include <numeric>

#include "core/util/number.h"
#include "lab/report/figures.h"
#include "lab/report/html.h"

namespace lab::report {
namespace {

using nlohmann::json;

double value(const json& from, const char* key) {
  return from.contains(key) && from[key].is_number() ? from[key].get<double>() : NAN;
}
std::string cell(const json& from, const char* key, int digits = 4) {
  return figure(value(from, key), digits);
}

/// "12.5 mrad" with the unit small.
std::string with_unit(double number, const std::string& unit) {
  if (!std::isfinite(number)) return "–";
  const Scale scale =
      unit == "rad" || unit == "m" || unit == "J" ? scale_for(std::abs(number), unit) : Scale{1, unit};
  return figure(number * scale.factor, 3) + " <small>" + escape(scale.unit) + "</small>";
}

/// "rad" and "Nm", "m" and "N", or both of a robot that has both kinds of joints.
std::pair<std::string, std::string> units(const rbd::Model& model) {
  bool turns = false, slides = false;
  for (const TrackedJoint& joint : joints_of(model))
    (unit_of(model, joint.iv) == "m" ? slides : turns) = true;
  return turns && slides ? std::pair("rad, m", "Nm, N")
         : slides        ? std::pair("m", "N")
                         : std::pair("rad", "Nm");
}

std::string key_figures(const json& m, const rbd::Model& model) {
  const auto [length, effort] = units(model);
  std::string out = "<dl class=\"key\">\n";
  const auto add = [&](const std::string& label, const std::string& text) {
    out += "<div><dt>" + label + "</dt><dd>" + text + "</dd></div>\n";
  };
  add("largest error", with_unit(value(m, "max_error"), length));
  add("RMS error", with_unit(value(m, "rms_error"), length));
  if (m.contains("tool_frame") && m["tool_frame"].is_string())
    add("largest tool error", with_unit(value(m, "max_tool_error"), "m"));
  if (value(m, "reach_count") > 0) {
    const double settling = value(m, "reach_settling_max");
    add("settling, slowest reach",
        std::isfinite(settling) ? with_unit(settling, "s") : "<span class=\"bad\">never</span>");
    if (std::isfinite(value(m, "overshoot_share_max")))
      add("overshoot", with_unit(100 * value(m, "overshoot_share_max"), "%"));
  }
  if (value(m, "max_effort_share") > 0)
    add("effort, of the limit", with_unit(100 * value(m, "max_effort_share"), "%"));
  add("largest effort", with_unit(value(m, "max_effort"), effort));
  add("energy drift", with_unit(value(m, "energy_drift"), "J"));
  if (m.contains("handbook_grade")) {
    std::string grade = m["handbook_grade"];
    if (grade == "needs_tuning") grade = "needs tuning";
    add("handbook's grade", grade);
  }
  return out + "</dl>\n";
}

std::string verdict_table(const json& m) {
  if (m["verdicts"].empty())
    return missing("Nothing was expected of this run: its experiment has no expect.");
  Table table{{"", "metric", "value", "at least", "at most"}, {}, 2};
  for (const json& one : m["verdicts"]) {
    const bool ok = one["ok"];
    table.rows.push_back({ok ? "<span class=\"good\">✓ met</span>" : "<span class=\"bad\">✗ missed</span>",
                          "<code>" + escape(one["metric"].get<std::string>()) + "</code>", cell(one, "value"),
                          one.contains("min") ? cell(one, "min") : "",
                          one.contains("max") ? cell(one, "max") : ""});
  }
  return table.html();
}

std::string film(const Folder& folder) {
  if (folder.pictures.empty())
    return missing(folder.frames ? "The frames are too large for a page; they are in frames/."
                                 : "No pictures: nobody drew this run (a solo run, or renderer.enabled: "
                                   "false). scripts/lab render makes them from the log.");
  std::string out = folder.pictures.size() > 1 ? "<div class=\"film\">\n" : "<figure class=\"film\">\n";
  for (const std::string& png : folder.pictures)
    out += "<img alt=\"the robot in the course of the run\" src=\"data:image/png;base64," + base64(png) +
           "\">\n";
  return out + (folder.pictures.size() > 1 ? "</div>\n" : "</figure>\n");
}

std::string joint_table(const Run& run, const json& m) {
  const std::vector<std::pair<const char*, const char*>> columns = {
      {"max_error", "max error"},
      {"mean_error", "mean error"},
      {"rms_error", "RMS error"},
      {"final_error", "final error"},
      {"max_effort", "max effort"},
      {"rms_effort", "RMS effort"},
      {"max_effort_share", "share of limit"},
      {"max_speed", "max speed"},
      {"max_speed_share", "share of limit"},
      {"min_position_margin", "margin to limit"}};
  Table table{{"joint", "unit"}, {}, 2, true};
  for (const auto& [key, label] : columns) table.head.push_back(label);
  for (const TrackedJoint& joint : joints_of(run.model))
    for (const json& one : m["joints"]) {
      if (one["name"] != joint.name) continue;
      std::vector<std::string> row{escape(joint.name), unit_of(run.model, joint.iv)};
      for (const auto& [key, label] : columns) row.push_back(cell(one, key, 3));
      table.rows.push_back(row);
    }
  std::vector<std::string> all{"all", ""};
  for (const auto& [key, label] : columns) all.push_back(cell(m, key, 3));
  table.rows.push_back(all);
  return table.html();
}

std::string reach_tables(const json& m) {
  if (m["reaches"].empty()) return missing("No reaches: the reference never came to rest at a new place.");
  Table table{{"reach", "arrives (s)", "rests until (s)", "settling (s)", "overshoot", "% of the way",
               "steady error", "slowest joint"},
              {},
              1};
  int number = 0;
  for (const json& reach : m["reaches"]) {
    std::string slowest = "–";
    double longest = 0;
    for (const json& joint : reach["joints"]) {
      const double settling = value(joint, "settling");
      if (std::isnan(settling) || settling > longest) slowest = joint["name"], longest = settling;
      if (std::isnan(settling)) break;
    }
    const double settling = value(reach, "reach_settling_max");
    table.rows.push_back({std::to_string(++number), cell(reach, "arrival"), cell(reach, "end"),
                          std::isnan(settling) ? "<span class=\"bad\">never</span>" : figure(settling),
                          cell(reach, "overshoot_max"), figure(100 * value(reach, "overshoot_share_max"), 3),
                          cell(reach, "steady_error_max"), escape(slowest)});
  }
  return "<p class=\"soft\">Settling counts from the reference's arrival until every joint stays within " +
         figure(value(m, "band")) + " of the target.</p>\n" + table.html();
}

std::string note_table(const std::vector<Note>& notes) {
  if (notes.empty()) return missing("Nothing happened: no limit was met, nobody interfered.");
  constexpr size_t kMost = 60;
  Table table{{"time (s)", "by", "what", "about", "why"}, {}, 5};
  for (const Note& note : notes) {
    if (table.rows.size() == kMost) break;
    table.rows.push_back(
        {figure(note.time, 6), escape(note.who), escape(note.what), escape(note.about), escape(note.why)});
  }
  std::string out = table.html();
  if (notes.size() > kMost)
    out += missing("and " + std::to_string(notes.size() - kMost) + " more: the log has all of them.");
  return out;
}

std::string loop_table(const std::vector<Loops>& all) {
  Table table{
      {"process", "loops", "p50 (µs)", "p99 (µs)", "p99.9 (µs)", "overruns", "lateness p50, p99, max (µs)"},
      {},
      1};
  for (const Loops& loops : all)
    table.rows.push_back(
        {escape(loops.process),
         std::to_string(std::accumulate(loops.counts.begin(), loops.counts.end(), int64_t{0})),
         std::to_string(loop_quantile(loops, 0.5)), std::to_string(loop_quantile(loops, 0.99)),
         std::to_string(loop_quantile(loops, 0.999)), std::to_string(loops.overruns),
         loops.late_max > 0
             ? figure(loops.late_p50) + ", " + figure(loops.late_p99) + ", " + figure(loops.late_max, 6)
             : "–"});
  return table.html();
}

std::string metric_table(const json& m) {
  Table table{{"metric", "value", "unit"}, {}, 1};
  for (const Metric& metric : metrics())
    table.rows.push_back(
        {std::string("<code>") + metric.name + "</code>", cell(m, metric.name), metric.unit});
  return table.html();
}

std::string version_table(const json& manifest) {
  if (manifest.is_null()) return missing("No manifest.json: the run was killed, or still goes on.");
  Table table{{}, {}, 2};
  const auto add = [&](const std::string& label, const json& what) {
    if (what.is_null()) return;
    table.rows.push_back({escape(label), escape(what.is_string() ? what.get<std::string>() : what.dump())});
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
  if (manifest.contains("libraries"))
    for (const auto& [name, version] : manifest["libraries"].items()) add(name, version);
  if (manifest.contains("hashes"))
    for (const auto& [name, hash] : manifest["hashes"].items()) add("hash of " + name, hash);
  if (manifest.contains("exit_codes")) {
    std::string codes;
    for (const auto& [name, code] : manifest["exit_codes"].items())
      codes += (codes.empty() ? "" : ", ") + name + " " + code.dump();
    add("exit codes", codes);
  }
  return table.html();
}

}  // namespace

Badge badge_of(const Folder& folder) {
  const json codes =
      folder.manifest.is_object() ? folder.manifest.value("exit_codes", json::object()) : json::object();
  const int code = codes.contains("run") && codes["run"].is_number_integer() ? codes["run"].get<int>() : 0;
  if (code == 124) return {"timed out"};
  if (code == 130 || code == 143 || code == 129) return {"stopped"};
  if (code > 1) return {"ended with exit " + std::to_string(code)};
  if (!folder.logged) return {"no log"};
  if (!folder.metrics["complete"].get<bool>()) return {"incomplete"};
  if (folder.metrics["verdicts"].empty()) return {"complete", true};
  return folder.metrics["passed"].get<bool>() ? Badge{"as expected", true} : Badge{"not as expected"};
}

std::string badge_html(const Badge& badge) {
  return std::string("<span class=\"badge ") + (badge.good ? "good\">✓ " : "bad\">✗ ") + escape(badge.text) +
         "</span>";
}

std::string about(const Folder& folder) {
  if (!folder.experiment) return "";
  const Experiment& e = *folder.experiment;
  std::string out;
  if (folder.logged)
    out += folder.logged->robot.model.name + ", " +
           std::to_string(joints_of(folder.logged->run.model).size()) + " joints · ";
  out += e.planner.kind + " · " + e.controller.kind + " · " + number(e.simulator.duration) +
         " s in steps of " + number(e.simulator.dt) + " s · " + e.simulator.clock;
  return out;
}

Page run_page(const Folder& folder) {
  const std::string name = folder.experiment ? folder.experiment->name : folder.name;
  std::string body = "<header>\n<div class=\"title\"><h1>" + escape(name) + "</h1>" +
                     badge_html(badge_of(folder)) + "</div>\n<p class=\"about\">" + escape(about(folder)) +
                     "</p>\n";
  const json& m = folder.metrics;
  const bool any = folder.logged && !folder.logged->run.states.empty();
  Page page;
  std::vector<Gallery> galleries;
  if (any) {
    const Run& run = folder.logged->run;
    galleries = {tracking_gallery(run), error_gallery(run), effort_gallery(run), tool_gallery(run),
                 energy_gallery(run)};
  }
  galleries.push_back(loop_gallery(folder.loops));
  const Shown shown = show(galleries);
  page.drawn = shown.drawn;

  if (!folder.logged)
    body += missing("There is nothing to show of the motion: " + folder.no_log + ".");
  else if (!any)
    body += missing("There is nothing to show of the motion: the log has no whole step.");
  else if (!m["complete"].get<bool>())
    body += "<p class=\"bad\">The run ended at step " + m["last_step"].dump() + " of " +
            m["wanted_last_step"].dump() +
            (m["reason"].get<std::string>().empty() ? "" : ": " + escape(m["reason"].get<std::string>())) +
            ".</p>\n";
  for (const auto& [name, text] : folder.last_words)
    body += "<p class=\"bad\">" + escape(name) + "</p>\n<pre>" + escape(text) + "</pre>\n";
  if (any) body += key_figures(m, folder.logged->run.model);
  body += "</header>\n";
  if (any) body += section("Expected", verdict_table(m));
  body += section("Pictures", film(folder));
  if (any) {
    const std::string &energy = shown.html[4], &tool = shown.html[3];
    body += section("Motion", shown.html[0]);
    const std::string band = figure(value(m, "band"));
    body +=
        section("Error", "<p class=\"soft\">" +
                             (value(m, "max_error") <= value(m, "band") ? "All joints stay within " + band
                                                                        : "Shaded: within " + band) +
                             " of the reference.</p>\n" + shown.html[1] + joint_table(folder.logged->run, m));
    body += section("Reaches", reach_tables(m));
    body += section("Effort", shown.html[2]);
    body += tool.empty() ? section("Tool", missing("This robot has no link whose path could be shown."))
                         : section("Tool: " + m["tool_frame"].get<std::string>(), tool);
    body += section("Energy",
                    energy.empty()
                        ? missing("Energy and work need every step, and the log does not hold all of them.")
                        : energy);
  }
  if (folder.logged) body += section("Events", note_table(folder.notes));
  body +=
      section("Loop times",
              folder.loops.empty()
                  ? missing("No loop times: telemetry.lcm has none (a solo run has no processes to time).")
                  : "<p class=\"soft\">From waking up to being done, by the wall clock: these differ from "
                    "run to run.</p>\n" +
                        shown.html.back() + loop_table(folder.loops));
  std::string columns = "<div class=\"columns\">\n";
  if (any) columns += section("All metrics", metric_table(m));
  columns += section("Made with", version_table(folder.manifest)) + "</div>\n";
  body += columns;
  body += section("Experiment as run", folder.experiment_text.empty()
                                           ? missing("No experiment.yaml in the folder.")
                                           : "<pre>" + escape(folder.experiment_text) + "</pre>\n");
  page.html = report::page(name, body);
  return page;
}

}  // namespace lab::report
