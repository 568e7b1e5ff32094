#include <filesystem>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/run/shell.h"
#include "procs/logger/log_files.h"
#include "procs/logger/role.h"

namespace {

int run(int argc, char** argv) {
  lab::CommandLine line(
      "lab-logger",
      "The logger of a lab: writes log.lcm, whose bytes are what the simulator used, and telemetry.lcm.");
  line.footer("example: lab-logger --run-dir runs/latest");
  lab::ParticipantOptions options{.name = lab::kLogger, .url = "", .prefix = "", .channels = {}};
  std::string run_dir;
  double deadline = 10, ready = 10, quota = 0;
  line.option("--run-dir", run_dir, "folder that the logs go to").env("LAB_RUN_DIR").required();
  lab::add_bus_options(line, options.url, options.prefix, "-l,--lcm-url,--url");
  lab::add_waits(line, deadline, ready);
  line.option("--quota-mb", quota,
              "of log.lcm and of telemetry.lcm: at half of it what was written becomes log.earlier.lcm, "
              "in place of "
              "the one before (0: no limit, as for every run in lockstep)")
      .env("LAB_QUOTA_MB")
      .range(0, 1e9);
  if (const auto code = line.parse(argc, argv)) return *code;
  return lab::guarded_main("lab-logger", [&] {
    lab::logger::LogFiles files(run_dir, static_cast<uint64_t>(quota * 1e6));
    lab::Participant participant(options);
    lab::LoggerConfig config;
    if (const std::string file = run_dir + "/experiment.yaml"; std::filesystem::exists(file))
      config.every = lab::load_experiment(file).logger.every;
    config.deadline = std::llround(deadline * 1e6);
    config.ready_deadline = std::llround(ready * 1e6);
    const auto role = lab::logger::make_role(config, files, participant.publish());
    return participant.run(*role);
  });
}

}  // namespace

int main(int argc, char** argv) {
  return lab::run_program("lab-logger", [&] { return run(argc, argv); });
}
