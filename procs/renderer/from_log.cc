#include "procs/renderer/from_log.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "core/util/console.h"
#include "core/util/number.h"
#include "core/util/progress.h"
#include "lab/experiment/experiment_yaml.h"
#include "procs/renderer/frames.h"
#include "procs/renderer/logged.h"
#include "procs/renderer/video.h"
#include "procs/renderer/workers.h"
#include "wire/log/checked_log.h"
#include "wire/protocol/role.h"

namespace lab::renderer {
namespace {

namespace fs = std::filesystem;
using Moments = std::vector<Snapshot>;

constexpr double kVideoRate = 30;  // pictures per second of a film, unless said

/// Bars below each other line up; short jobs have none.
Progress::Style bar(const std::string& label) {
  return {.label = fmt::format("{:<9}", label), .keep = true, .shown_above = 10};
}

/// The experiment with the renderer keys of the run's own experiment.yaml, overridden by those of the command line.
Experiment experiment_of(const FromLog& job, const Logged& logged, const std::string& path,
                         std::string& meshes) {
  Experiment e = parse_experiment(logged.run.experiment, "RUN in " + path);
  const std::string beside = (fs::absolute(path).parent_path() / "experiment.yaml").string();
  meshes = "RUN";
  if (fs::exists(beside)) {
    const Experiment as_run = load_experiment(beside);
    e.renderer = as_run.renderer;
    if (!logged.run.urdf.empty()) meshes = find_model(as_run);
  }
  auto& r = e.renderer;
  if (job.width) r.size = {job.width, job.height};
  if (!job.camera.empty()) r.camera = job.camera;
  if (!job.quality.empty()) r.quality = job.quality;
  r.orthographic |= job.orthographic;
  r.reference |= job.reference;
  r.orbit = job.orbit.value_or(r.orbit);
  r.ghost = job.ghost.value_or(r.ghost);
  const auto set_frame = [&](const std::optional<std::string>& option, std::string& frame, const char* key) {
    if (!option) return;
    frame = *option;
    e.where[std::string("renderer.") + key] = std::string("--") + key;
  };
  set_frame(job.follow, r.follow, "follow");
  set_frame(job.trace, r.trace, "trace");
  if (job.trace_by != "time" && r.trace.empty())
    throw ExperimentError("--trace-by: there is no trace to colour; name its frame with --trace");
  return e;
}

/// The logged step nearest to a requested one.
int64_t nearest(const std::vector<int64_t>& logged, int64_t step) {
  const auto after = std::lower_bound(logged.begin(), logged.end(), step);
  if (after == logged.end()) return logged.back();
  return after != logged.begin() && step - after[-1] <= *after - step ? after[-1] : *after;
}

std::vector<int64_t> nearest(const std::vector<int64_t>& logged, std::vector<int64_t> steps) {
  for (int64_t& step : steps) step = nearest(logged, step);
  return steps;
}

std::vector<int64_t> steps_at_times(const FromLog& job, double dt, int64_t last_step) {
  std::vector<int64_t> steps;
  for (double time : job.times) {
    const double step = std::round(time / dt);
    if (!(step >= 0 && step <= static_cast<double>(last_step)))
      throw ExperimentError(fmt::format("--times: {} s is outside the run, which lasts from 0 to {} s",
                                        number(time), number(static_cast<double>(last_step) * dt)));
    steps.push_back(static_cast<int64_t>(step));
  }
  return steps;
}

/// The snapshots of steps, in their order.
Moments moments_of(const std::map<int64_t, Snapshot>& all, const std::vector<int64_t>& steps) {
  Moments out;
  for (int64_t step : steps)
    if (const auto found = all.find(step); found != all.end()) out.push_back(found->second);
  return out;
}

/// Every i-th frame of a clip.
class FrameWorker : public Worker {
 public:
  FrameWorker(const RunScene& run, const Moments& snapshots, const FromLog& job, const std::string& folder,
              render::PngTexts about)
      : run_(run),
        snapshots_(snapshots),
        depth_(job.depth),
        ids_(job.ids),
        painter_(run_),
        files_(folder, with_gl(std::move(about))) {}

  void draw(int64_t index) override {
    const Shot shot = run_.shot(snapshots_[static_cast<size_t>(index)]);
    files_.write(index, painter_.draw(shot));
    if (!depth_ && !ids_) return;
    const render::Measurement seen = painter_.measure(shot);
    const render::PngTexts texts = texts_of(shot, run_.settings().camera);
    if (depth_) files_.write_depth(index, seen, texts);
    if (ids_) files_.write_ids(index, seen, texts, run_.links());
  }
  void finish() override { files_.finish(); }

 private:
  render::PngTexts with_gl(render::PngTexts about) const {
    about.emplace_back("renderer", painter_.gl_info());
    return about;
  }

  RunScene run_;
  const Moments& snapshots_;
  bool depth_, ids_;
  Painter painter_;
  FrameFolder files_;
};

/// A folder for pictures that only the video needs; goes with this object.
struct Scratch {
  std::string folder;
  explicit Scratch(const std::string& video) {
    const fs::path target = fs::absolute(video);
    folder = (target.parent_path() / ("." + target.filename().string() + ".frames")).string();
  }
  ~Scratch() {
    std::error_code none;
    fs::remove_all(folder, none);
  }
};

/// What is drawn at which steps.
struct Plan {
  double fps;  ///< of a film
  std::vector<int64_t>
      film;  ///< steps, as the four below: of each picture of a film, some perhaps several times
  std::vector<int64_t> pictures;
  std::vector<int64_t> cells;    ///< of contact.png
  std::vector<int64_t> samples;  ///< of traces and ghosts
  int64_t ghosts;                ///< of ghost.png; 0 = none
};

Plan make_plan(const FromLog& job, const Experiment& experiment, const Logged& logged) {
  const double dt = experiment.simulator.dt;
  const int64_t last_step = logged.steps.back();
  const bool only_overviews =
      (job.ghost.value_or(0) > 0 || job.contact > 0) && job.times.empty() && !job.fps && job.video.empty();
  const bool film_only = job.folder.empty();
  Plan plan{.fps = job.fps.value_or(job.video.empty() ? experiment.renderer.fps : kVideoRate),
            .film = {},
            .pictures = {},
            .cells = {},
            .samples = {},
            .ghosts = job.ghost.value_or(job.times.empty() && !film_only ? experiment.renderer.ghost : 0)};
  if (!job.times.empty())
    plan.pictures = steps_at_times(job, dt, last_step);
  else if (!job.video.empty())
    plan.film = steps_of_film(plan.fps, dt, last_step);
  else if (!only_overviews)
    plan.pictures = steps_at_rate(plan.fps, dt, last_step);
  for (int64_t i = 0; i < job.contact; ++i)
    plan.cells.push_back(job.contact == 1 ? last_step : i * last_step / (job.contact - 1));
  for (int64_t step = 0; step < last_step; step += sample_gap(experiment)) plan.samples.push_back(step);
  plan.samples.push_back(last_step);
  for (std::vector<int64_t>* steps : {&plan.film, &plan.pictures, &plan.cells, &plan.samples})
    *steps = nearest(logged.steps, std::move(*steps));
  if (!plan.film.empty()) plan.pictures = plan.film;
  if (job.times.empty())  // fewer are logged than requested
    plan.pictures.erase(std::unique(plan.pictures.begin(), plan.pictures.end()), plan.pictures.end());
  return plan;
}

/// The snapshots at all steps of a plan.
std::map<int64_t, Snapshot> read_planned(const Plan& plan, const std::string& path, double dt) {
  std::vector<int64_t> all = plan.pictures;
  all.insert(all.end(), plan.cells.begin(), plan.cells.end());
  all.insert(all.end(), plan.samples.begin(), plan.samples.end());
  std::sort(all.begin(), all.end());
  return read_snapshots(path, all, dt);
}

RunScene make_scene(const FromLog& job, const Experiment& experiment, const Robot& robot,
                    const Logged& logged, const Moments& samples) {
  Extras extras{job.trace_by, job.arrows, logged.pushes};
  for (const PlannedPush& push : experiment.simulator.pushes)
    extras.pushes.push_back(
        {push.time, push.time + push.duration, push.frame, {push.force[0], push.force[1], push.force[2]}});
  RunScene run(robot, experiment, std::move(extras));
  for (const auto& warning : run.warnings()) say("lab-renderer: warning: {}", warning);
  if (job.strict && !run.warnings().empty())
    throw ExperimentError("--strict: the robot is not whole, so nothing is drawn");
  for (const Snapshot& snapshot : samples) run.remember(snapshot);
  run.finish_run();
  return run;
}

void draw_frames(const FromLog& job, const RunScene& run, const Moments& snapshots, const std::string& folder,
                 const render::PngTexts& about) {
  const auto count = static_cast<int64_t>(snapshots.size());
  const bool list_files = !job.folder.empty();
  Progress progress(count, bar("pictures"));
  draw_all(
      count, job.workers ? job.workers : sensible_workers(count),
      [&]() -> std::unique_ptr<Worker> {
        return std::make_unique<FrameWorker>(run, snapshots, job, folder, about);
      },
      [&](int64_t index) {
        progress.show(index + 1);
        if (list_files && !progress.on_terminal()) emit("{}\n", frame_path(folder, index));
      });
}

/// The film: each picture for as long as it is the nearest one, by links to it in a folder of numbered ones.
void write_film(const FromLog& job, const Plan& plan, const std::string& pictures, const std::string& scratch,
                const std::string& title) {
  const auto count = static_cast<int64_t>(plan.film.size());
  std::string folder = pictures;
  if (plan.film.size() != plan.pictures.size()) {
    folder = scratch + "/film";
    make_folder(folder);
    for (int64_t i = 0; i < count; ++i) {
      const auto shown =
          std::lower_bound(plan.pictures.begin(), plan.pictures.end(), plan.film[static_cast<size_t>(i)]);
      fs::create_symlink(fs::absolute(frame_path(pictures, shown - plan.pictures.begin())),
                         frame_path(folder, i));
    }
  }
  Progress progress(count, bar("video"));
  write_video(job.video, folder, count, plan.fps, title, [&](int64_t done) { progress.show(done); });
  emit("{}\n", job.video);
}

void write_overview(const Moments& snapshots, const std::string& folder) {
  std::vector<double> times;
  for (const Snapshot& snapshot : snapshots) times.push_back(snapshot.time);
  write_contact_sheet_of(folder + "/contact.png", folder, times);
  emit("{}/contact.png\n", folder);
}

/// The pictures of the whole run: contact sheet and ghosts.
void draw_overviews(const std::string& folder, RunScene& run, const Moments& for_contact, int64_t ghosts,
                    render::PngTexts about) {
  if (for_contact.empty() && ghosts == 0) return;
  Painter painter(run);
  about.emplace_back("renderer", painter.gl_info());
  make_folder(folder);
  const std::string contact = folder + "/contact.png", ghost = folder + "/ghost.png";
  if (!for_contact.empty()) {
    std::vector<Stamped> pictures;
    for (const Snapshot& snapshot : for_contact)
      pictures.push_back({thumbnail(painter.draw(run.shot(snapshot)).image), snapshot.time});
    write_contact_sheet(contact, pictures, about);
    emit("{}\n", contact);
  }
  if (ghosts > 0) {
    Picture picture = painter.draw(run.ghosts(ghosts));
    picture.texts.insert(picture.texts.begin(), about.begin(), about.end());
    render::write_png(ghost, picture.image, picture.texts);
    emit("{}\n", ghost);
  }
}

}  // namespace

int render_log(const FromLog& job) {
  if (!job.video.empty()) need_ffmpeg();  // before the long part
  if (!job.folder.empty()) check_folder(job.folder);
  const std::string path = find_log(job.source);
  const Logged logged = survey(path);
  for (const std::string& line : lines_of(logged.log)) say("lab-renderer: {}: {}", path, line);
  std::string meshes;
  const Experiment experiment = experiment_of(job, logged, path, meshes);
  const Robot robot =
      logged.run.urdf.empty() ? load_robot(experiment) : load_robot(experiment, logged.run.urdf, meshes);
  const Plan plan = make_plan(job, experiment, logged);
  const auto read = read_planned(plan, path, experiment.simulator.dt);
  RunScene run = make_scene(job, experiment, robot, logged, moments_of(read, plan.samples));

  const std::string id = fmt::format("{:016x}", static_cast<uint64_t>(logged.run.run));
  const Moments snapshots = moments_of(read, plan.pictures);
  std::optional<Scratch> scratch;
  if (!job.video.empty()) scratch.emplace(job.video);
  const std::string folder = scratch && job.folder.empty() ? scratch->folder : job.folder;
  if (!snapshots.empty()) draw_frames(job, run, snapshots, folder, {{"run", id}});
  if (snapshots.size() > 1 && job.contact == 0 && !job.folder.empty()) write_overview(snapshots, folder);
  if (scratch) write_film(job, plan, folder, scratch->folder, "run " + id);
  draw_overviews(job.folder, run, moments_of(read, plan.cells), plan.ghosts, {{"run", id}});
  return logged.log.complete() || (logged.log.sound() && is_being_written(path)) ? kOk : kCheckFailed;
}

}  // namespace lab::renderer
