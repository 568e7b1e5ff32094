#include <fmt/format.h>

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
  lab::Option source, video, folder;
};

/// What to make.
LogOptions add_outputs(lab::CommandLine& line, FromLog& job) {
  const lab::Option source = line.option("source", job.source, "log.lcm or a run folder");
  const auto add = [&](lab::Option option) { return option.needs(source); };
  const lab::Option fps =
      add(line.option("--fps", job.fps, "pictures per second of simulation time")).range(1e-3, 1e4);
  add(line.option("--times", job.times, "pictures at these times: s, separated by commas"))
      .separated_by(',')
      .excludes(fps);
  add(line.option("--contact", job.contact, "contact.png of this many pictures")).range(1, 200);
  add(line.option("--ghost", job.ghost, "ghost.png: the whole path in this many poses")).range(1, 100);
  const lab::Option video = add(line.option(
      "--video", job.video, "a film (.mp4) of the pictures, 30 per second unless --fps says otherwise"));
  add(line.flag("--depth", job.depth, "depths beside each picture: 16-bit PNG in mm, and float32 in m"));
  add(line.flag("--ids", job.ids, "numbers of links beside each picture: 16-bit PNG"));
  add(line.flag("--strict", job.strict, "no pictures if a mesh or texture is missing or broken"));
  add(line.option("-j,--jobs", job.workers, "processes that draw at once")).range(1, 64);
  const lab::Option folder = add(line.option("-o,--output", job.folder, "folder for the pictures"));
  return {source, video, folder};
}

/// How it looks.
void add_appearance(lab::CommandLine& line, FromLog& job, lab::Option source) {
  const auto add = [&](lab::Option option) { return option.needs(source); };
  const auto size = [&job](const std::string& text) { return read_size(text, job.width, job.height); };
  add(line.read("--size", size, "WIDTHxHEIGHT, pixels"));
  add(line.option("--quality", job.quality, "draft, live or fine")).one_of({"draft", "live", "fine"});
  add(line.option("--camera", job.camera, "iso, front, side or top")).one_of(lab::render::view_names());
  add(line.flag("--orthographic", job.orthographic, "without perspective"));
  add(line.option("--orbit", job.orbit, "rad/s: the camera orbits the robot")).range(-100, 100);
  add(line.option("--follow", job.follow, "frame that the camera goes along with"));
  add(line.option("--trace", job.trace, "frame whose path is drawn"));
  add(line.option("--trace-by", job.trace_by, "what its colours mean: time, speed or error"))
      .one_of({"time", "speed", "error"});
  add(line.flag("--reference", job.reference, "the reference pose as a green ghost"));
  add(line.option("--arrows", job.arrows, "velocity, force, com and frames, separated by commas"))
      .separated_by(',')
      .one_of({"velocity", "force", "com", "frames"});
}

/// "" or what is wrong with options together.
std::string check_together(const FromLog& job, const LogOptions& options) {
  const bool video = options.video.given(), folder = options.folder.given();
  if (options.source.given() && !folder && (!video || job.depth || job.ids || job.ghost || job.contact))
    return "-o is required";
  if (video && !job.video.ends_with(".mp4")) return "--video: must be the name of an .mp4 file";
  if (video && !job.times.empty()) return "--video: is made at a rate (--fps), not of single --times";
  return "";
}

int run(int argc, char** argv) {
  lab::CommandLine line(
      "lab-renderer",
      "Draws the robot of a run: live beside it (--run-dir), or afterwards from a log or a run folder.");
  line.footer("example: lab-renderer runs/latest --times 0,1.5 --size 1280x720 --quality fine -o pictures");
  lab::ParticipantOptions participation{
      .name = "renderer",
      .url = "",
      .prefix = "",
      .channels = {lab::Channel::Run, lab::Channel::RobotState, lab::Channel::End}};
  std::string run_dir;
  FromLog job;
  const lab::Option live = line.option(
      "--run-dir", run_dir, "the run folder: reads experiment.yaml, writes frames/, contact.png, ghost.png");
  lab::add_bus_options(line, participation.url, participation.prefix);
  const LogOptions options = add_outputs(line, job);
  lab::Option(options.source).excludes(live);
  add_appearance(line, job, options.source);
  line.check([&]() -> std::string {
    if (run_dir.empty() && job.source.empty()) return "--run-dir, or a log is required";
    return check_together(job, options);
  });
  if (const auto code = line.parse(argc, argv)) return *code;
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
