#include "lab/tool/verdict.h"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/util/exit_code.h"
#include "core/util/number.h"
#include "lab/evaluation/metrics.h"
#include "lab/page/template.h"
#include "lab/tool/manifest.h"

namespace lab {
namespace {

using nlohmann::json;
using nlohmann::ordered_json;

/// What the supervisor said at the end.
std::string reason_of(const std::string& run_dir) {
  std::ifstream in(run_dir + "/processes/state");
  for (std::string line; std::getline(in, line);)
    if (line.starts_with("reason ")) return line.substr(7);
  return "";
}

const char* word_for(int code) {
  if (code == kOk) return "ok";
  if (code == kCheckFailed) return "failed";
  return was_stopped(code) ? "stopped" : "error";
}

/// As the value of an attribute, whose line feeds would be read as spaces.
std::string xml(const std::string& text) {
  std::string out = page::escape(text);
  for (size_t at = 0; (at = out.find('\n', at)) != std::string::npos; at += 5) out.replace(at, 1, "&#10;");
  return out;
}

/// "max_error is 0.3 rad, m, at most 0.1"
std::string words_of(const ordered_json& verdict) {
  const std::string metric = verdict["metric"];
  const Metric* const known = metric_of(metric);
  const std::string unit = known && *known->unit ? std::string(" ") + known->unit : "";
  const ordered_json& value = verdict["value"];
  std::string text =
      metric + " is " + (value.is_number() ? rounded(value.get<double>()) + unit : "not known");
  if (verdict.contains("min")) text += ", at least " + rounded(verdict["min"].get<double>());
  if (verdict.contains("max")) text += ", at most " + rounded(verdict["max"].get<double>());
  return text + " is expected";
}

}  // namespace

ordered_json run_verdict(const std::string& run_dir, const std::string& name, int exit_code,
                         const std::string& reason) {
  const json manifest = run_dir.empty() ? json() : object_in(run_dir + "/manifest.json");
  // metrics of the run in this folder, not of one before it: they exist when it was evaluated
  const bool evaluated = exit_code == kOk || exit_code == kCheckFailed;
  const json metrics = run_dir.empty() || !evaluated ? json() : object_in(run_dir + "/metrics.json");
  ordered_json out;
  out["name"] = name;
  out["folder"] = run_dir.empty() ? json(nullptr) : json(run_dir);
  out["exit_code"] = exit_code;
  out["verdict"] = word_for(exit_code);
  out["reason"] = !reason.empty() || run_dir.empty() ? reason : reason_of(run_dir);
  out["wall_seconds"] = member(manifest, "wall_seconds");
  out["verdicts"] = metrics.is_object() ? metrics.value("verdicts", json::array()) : json::array();
  out["metrics"] = metrics.is_object() ? metrics : json::object();
  return out;
}

std::string junit(const ordered_json& run) {
  const int code = run["exit_code"];
  const std::string name = xml(run["name"]);
  int failures = 0;
  std::string cases;
  for (const ordered_json& verdict : run["verdicts"]) {
    const bool ok = verdict["ok"];
    failures += !ok;
    cases += fmt::format("  <testcase classname=\"{}\" name=\"{}\"{}", name, xml(verdict["metric"]),
                         ok ? "/>\n" : ">\n");
    if (!ok) cases += fmt::format("    <failure message=\"{}\"/>\n  </testcase>\n", xml(words_of(verdict)));
  }
  // exit 1 without a bound that failed: the run ended too early
  const bool early = code == kCheckFailed && failures == 0, error = code != kOk && code != kCheckFailed;
  failures += early;
  std::string why = run["reason"];
  if (why.empty()) why = early ? "the run ended early" : fmt::format("exit code {}", code);
  cases += fmt::format("  <testcase classname=\"{}\" name=\"run\"{}", name, early || error ? ">\n" : "/>\n");
  if (early || error)
    cases += fmt::format("    <{} message=\"{}\"/>\n  </testcase>\n", error ? "error" : "failure", xml(why));
  const double seconds = run["wall_seconds"].is_number() ? run["wall_seconds"].get<double>() : 0;
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{}\" tests=\"{}\" failures=\"{}\" "
      "errors=\"{}\" time=\"{:.3f}\">\n{}</testsuite>\n",
      name, run["verdicts"].size() + 1, failures, error ? 1 : 0, seconds, cases);
}

}  // namespace lab
