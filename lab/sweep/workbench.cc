#include "lab/sweep/workbench.h"

#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "lab/check/unused.h"
#include "lab/evaluation/evaluate.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/experiment/hash.h"
#include "procs/controller/controller.h"
#include "procs/planner/planner.h"
#include "procs/simulator/simulator.h"
#include "procs/solo/direct.h"

namespace lab::sweep {
namespace {

constexpr size_t kMaxRobots = 64;

}  // namespace

Workbench::Workbench(const Sweep& sweep) : sweep_(sweep), program_(hash_of_file("/proc/self/exe")) {}

std::shared_ptr<const Robot> Workbench::robot_of(const Experiment& e) {
  Experiment about;  // what load_robot depends on
  about.robot = e.robot;
  about.simulator.gravity = e.simulator.gravity;
  const std::string key = resolve(about);
  const std::lock_guard guard(lock_);
  if (const auto known = robots_.find(key); known != robots_.end()) return known->second;
  if (robots_.size() >= kMaxRobots)
    robots_.clear();  // robots that vary from run to run are not worth keeping
  return robots_[key] = std::make_shared<const Robot>(load_robot(e));
}

Workbench::Job Workbench::prepare(const std::vector<Override>& overrides) {
  Job job;
  job.experiment = parse_experiment(sweep_.text, sweep_.experiment, overrides);
  const Experiment& e = job.experiment;
  if (e.simulator.clock != "lockstep")
    fail(e, "simulator.clock", "is " + e.simulator.clock + "; a sweep runs in one process: use lockstep");
  job.robot = robot_of(e);
  job.key =
      hex(hash_of(fmt::format("{}\n{}\n{}\n{}", canonical(e), e.logger.every, job.robot->hash, program_)));
  return job;
}

void Workbench::check() {
  // run 0 has the first value of every key; then one key at a time takes its other values
  std::vector<std::vector<Override>> samples{sweep_.overrides(0)};
  for (size_t i = 0; i < sweep_.grid.size(); ++i)
    for (const std::string& value : sweep_.grid[i].values) {
      samples.push_back(samples.front());
      samples.back()[sweep_.set.size() + i].text = sweep_.grid[i].key + "=" + value;
    }
  std::set<std::string> varies;  // sections whose kind does
  for (const std::string& key : sweep_.keys())
    if (key.ends_with(".kind")) varies.insert(key.substr(0, key.find('.')));
  for (const std::vector<Override>& sample : samples) {
    const Job job = prepare(sample);
    const rbd::Model& model = job.robot->model;
    check_unused(job.experiment, varies);
    simulator::make_config(job.experiment, model);
    planner::make_config(job.experiment, model);
    controller::make_config(job.experiment, model);
    Experiment asked = job.experiment;
    asked.expect.clear();
    for (const std::string& metric : sweep_.metrics) {
      asked.expect[metric] = {};
      asked.where["expect." + metric] = sweep_.metrics_place;
    }
    try {
      check_expect(asked, model);
    } catch (const ExperimentError& error) {
      std::string text = error.what();
      if (const size_t at = text.find(": expect."); at != std::string::npos)
        text.replace(at, 9, ": metrics: ");
      throw ExperimentError(text);
    }
    check_expect(job.experiment, model);
  }
}

std::string Workbench::reason(const std::exception& error) const {
  std::string text = error.what();
  for (const std::string& file : {sweep_.file, sweep_.experiment}) {
    const std::string plain = std::filesystem::path(file).filename();
    for (size_t at = 0; (at = text.find(file, at)) != std::string::npos; at += plain.size())
      text.replace(at, file.size(), plain);
  }
  for (size_t at; (at = text.find('\n')) != std::string::npos;) text.replace(at, 1, "; ");
  return text;
}

std::optional<std::string> Workbench::work(const Job& job, const std::function<bool()>& keep_going) const {
  const std::optional<Run> run = solo::run_direct(job.experiment, job.robot->model, keep_going);
  if (!run) return std::nullopt;
  return result_line(job.key, evaluate(*run, job.experiment.expect));
}

}  // namespace lab::sweep
