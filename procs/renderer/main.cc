#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <sstream>

#include "procs/experiment/experiment_yaml.h"
#include "procs/renderer/from_log.h"
#include "procs/renderer/role.h"
#include "procs/run/shell.h"

namespace {

std::vector<double> numbers(const std::string& text) {
  std::vector<double> values;
  std::stringstream stream(text);
  for (std::string word; std::getline(stream, word, ',');) {
    size_t used = 0;
    try {
      values.push_back(std::stod(word, &used));
    } catch (const std::exception&) {
    }
    if (used != word.size() || word.empty()) throw CLI::ValidationError("--times", "must be numbers in s, separated by commas, not '" + text + "'");
  }
  return values;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Draws the robot of a run: live beside it (--run-dir), or afterwards from a log or a run's folder.", "lab-renderer"};
  app.footer("example: lab-renderer runs/latest --times 0,1.5 --size 1280x720 --quality fine -o pictures");
  lab::ParticipantOptions options{.name = "renderer", .url = "", .prefix = "", .channels = {lab::Channel::Run, lab::Channel::RobotState, lab::Channel::End}};
  std::string run_dir, size, times;
  lab::renderer::FromLog job;
  auto* live = app.add_option("--run-dir", run_dir, "the run's folder: reads experiment.yaml, writes frames/ and contact.png");
  app.add_option("-l,--url", options.url, "LCM URL (default: env LCM_DEFAULT_URL)");
  app.add_option("--prefix", options.prefix, "of channel names, where several robots share a bus");
  auto* source = app.add_option("source", job.source, "log.lcm or a run's folder")->excludes(live);
  auto* fps = app.add_option("--fps", job.fps, "pictures per second of simulation time")->check(CLI::PositiveNumber)->needs(source);
  app.add_option("--times", times, "s of simulation time, separated by commas")->needs(source)->excludes(fps);
  app.add_option("--size", size, "WIDTHxHEIGHT")->needs(source);
  app.add_option("--camera", job.camera, "iso, front, side or top")->needs(source);
  app.add_option("--quality", job.quality, "draft, live or fine")->needs(source);
  app.add_option("-o,--output", job.folder, "folder for the pictures")->needs(source);
  try {
    app.parse(argc, argv);
    if (!times.empty()) job.times = numbers(times);
    if (!size.empty() && std::sscanf(size.c_str(), "%dx%d", &job.width, &job.height) != 2)
      throw CLI::ValidationError("--size", "must be like 640x480, not '" + size + "'");
    if (run_dir.empty() && job.source.empty()) throw CLI::RequiredError("--run-dir, or a log");
    if (!job.source.empty() && job.folder.empty()) throw CLI::RequiredError("-o");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? lab::kOk : lab::kUsage;
  }
  return lab::guarded_main("lab-renderer", [&] {
    if (!job.source.empty()) return lab::renderer::render_log(job);
    const lab::Experiment experiment = lab::load_experiment(run_dir + "/experiment.yaml");
    lab::Participant participant(options);
    lab::renderer::Watcher role(experiment, run_dir, participant.publish());
    return participant.run(role);
  });
}
