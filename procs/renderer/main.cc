#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/run/shell.h"
#include "procs/renderer/from_log.h"
#include "procs/renderer/role.h"

namespace {

using lab::renderer::FromLog;

/// WIDTHxHEIGHT; "" or what is wrong with it.
std::string read_size(const std::string& text, int& width, int& height) {
  int end = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &end) != 2 ||
      text[static_cast<size_t>(end)] != '\0')
    return "must be like 640x480, not '" + text + "'";
  constexpr int kMaxSide = 4096;
  if (width < 16 || height < 16 || width > kMaxSide || height > kMaxSide)
    return fmt::format("16 to {} pixels a side are possible, not {}", kMaxSide, text);
  return "";
}

/// Options of `lab-renderer LOG`. They check one another, so that a job that parses makes sense.
struct LogOptions {
  CLI::Option *source, *video, *folder;
};

/// What to make.
LogOptions add_outputs(CLI::App& app, FromLog& job) {
  LogOptions options{};
  options.source = app.add_option("source", job.source, "log.lcm or a run folder");
  const auto add = [&](CLI::Option* option) { return option->needs(options.source); };
  auto* fps = add(app.add_option("--fps", job.fps, "pictures per second of simulation time"))
                  ->check(CLI::Range(1e-3, 1e4));
  add(app.add_option("--times", job.times, "pictures at these times: s, separated by commas"))
      ->delimiter(',')
      ->excludes(fps);
  add(app.add_option("--contact", job.contact, "contact.png of this many pictures"))
      ->check(CLI::Range(1, 200));
  add(app.add_option("--ghost", job.ghost, "ghost.png: the whole path in this many poses"))
      ->check(CLI::Range(1, 100));
  options.video = add(app.add_option(
      "--video", job.video, "a film (.mp4) of the pictures, 30 per second unless --fps says otherwise"));
  add(app.add_flag("--depth", job.depth, "depths beside each picture: 16-bit PNG in mm, and float32 in m"));
  add(app.add_flag("--ids", job.ids, "numbers of links beside each picture: 16-bit PNG"));
  add(app.add_flag("--strict", job.strict, "no pictures if a mesh or texture is missing or broken"));
  add(app.add_option("-j,--jobs", job.workers, "processes that draw at once"))->check(CLI::Range(1, 64));
  options.folder = add(app.add_option("-o,--output", job.folder, "folder for the pictures"));
  return options;
}

/// How it looks.
void add_appearance(CLI::App& app, FromLog& job, CLI::Option* source) {
  const auto add = [&](CLI::Option* option) { return option->needs(source); };
  add(app.add_option("--size", "WIDTHxHEIGHT, pixels")->each([&job](const std::string& text) {
    if (const std::string fault = read_size(text, job.width, job.height); !fault.empty())
      throw CLI::ValidationError(fault);
  }));
  add(app.add_option("--quality", job.quality, "draft, live or fine"))
      ->check(CLI::IsMember({"draft", "live", "fine"}));
  add(app.add_option("--camera", job.camera, "iso, front, side or top"))
      ->check(CLI::IsMember(lab::render::view_names()));
  add(app.add_flag("--orthographic", job.orthographic, "without perspective"));
  add(app.add_option("--orbit", job.orbit, "rad/s: the camera orbits the robot"))
      ->check(CLI::Range(-100., 100.));
  add(app.add_option("--follow", job.follow, "frame that the camera goes along with"));
  add(app.add_option("--trace", job.trace, "frame whose path is drawn"));
  add(app.add_option("--trace-by", job.trace_by, "what its colours mean: time, speed or error"))
      ->check(CLI::IsMember({"time", "speed", "error"}));
  add(app.add_flag("--reference", job.reference, "the reference pose as a green ghost"));
  add(app.add_option("--arrows", job.arrows, "velocity, force, com and frames, separated by commas"))
      ->delimiter(',')
      ->check(CLI::IsMember({"velocity", "force", "com", "frames"}));
}

/// Throws CLI::ParseError for options that do not fit together.
void check_together(const FromLog& job, const LogOptions& options) {
  const bool video = options.video->count() > 0, folder = options.folder->count() > 0;
  if (options.source->count() > 0 && !folder && (!video || job.depth || job.ids || job.ghost || job.contact))
    throw CLI::RequiredError("-o");
  if (video && !job.video.ends_with(".mp4"))
    throw CLI::ValidationError("--video", "must be the name of an .mp4 file");
  if (video && !job.times.empty())
    throw CLI::ValidationError("--video", "is made at a rate (--fps), not of single --times");
}

int run(int argc, char** argv) {
  CLI::App app{
      "Draws the robot of a run: live beside it (--run-dir), or afterwards from a log or a run folder.",
      "lab-renderer"};
  app.footer("example: lab-renderer runs/latest --times 0,1.5 --size 1280x720 --quality fine -o pictures");
  app.get_formatter()->column_width(34);
  lab::ParticipantOptions participation{
      .name = "renderer",
      .url = "",
      .prefix = "",
      .channels = {lab::Channel::Run, lab::Channel::RobotState, lab::Channel::End}};
  std::string run_dir;
  FromLog job;
  auto* live = app.add_option(
      "--run-dir", run_dir, "the run folder: reads experiment.yaml, writes frames/, contact.png, ghost.png");
  app.add_option("-l,--url", participation.url, "LCM URL (default: env LCM_DEFAULT_URL)");
  app.add_option("--prefix", participation.prefix, "of channel names, where several robots share a bus")
      ->envname("LAB_PREFIX");
  const LogOptions options = add_outputs(app, job);
  options.source->excludes(live);
  add_appearance(app, job, options.source);
  app.final_callback([&] {
    if (run_dir.empty() && job.source.empty()) throw CLI::RequiredError("--run-dir, or a log");
    check_together(job, options);
  });
  if (const auto code = lab::parse_command_line(app, argc, argv)) return *code;
  return lab::guarded_main("lab-renderer", [&] {
    if (!job.source.empty()) return lab::renderer::render_log(job);
    const lab::Experiment experiment = lab::load_experiment(run_dir + "/experiment.yaml");
    if (experiment.renderer.reference) participation.channels.push_back(lab::Channel::Reference);
    lab::Participant participant(participation);
    lab::renderer::RendererRole role(experiment, run_dir, participant.publish());
    return participant.run(role);
  });
}

}  // namespace

int main(int argc, char** argv) {
  return lab::run_program("lab-renderer", [&] { return run(argc, argv); });
}
