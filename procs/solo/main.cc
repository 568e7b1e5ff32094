#include <fmt/format.h>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "core/util/interrupt.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/run/shell.h"
#include "procs/logger/log_files.h"
#include "procs/solo/solo.h"

namespace {

int run(int argc, char** argv) {
  lab::CommandLine line(
      "lab-solo",
      "Runs an experiment in one process, without a bus: log.lcm gets the same bytes as from separate "
      "processes.");
  line.footer("example: lab-solo experiments/cubic_pd.yaml --run-dir /tmp/run");
  std::string experiment_file, run_dir;
  std::vector<std::string> overrides;
  line.option("experiment", experiment_file, "YAML file").required();
  line.option("--run-dir", run_dir, "folder that log.lcm goes to").required();
  line.option("--set", overrides, "key=value over the file").one_word();
  if (const auto code = line.parse(argc, argv)) return *code;
  return lab::guarded_main("lab-solo", [&] {
    lab::install_signal_handlers();
    const lab::Experiment experiment = lab::load_experiment(experiment_file, overrides);
    if (experiment.simulator.clock != "lockstep")
      lab::fail(experiment, "simulator.clock",
                "is " + experiment.simulator.clock +
                    "; in one process there is no bus to be late on: use lockstep");
    const lab::Robot robot = lab::load_robot(experiment);
    lab::logger::LogFiles files(run_dir);
    const lab::Outcome outcome =
        lab::solo::run(experiment, robot, files, [](int64_t) { return !lab::interrupted; });
    if (!outcome.reason.empty()) lab::complain("lab-solo", outcome.reason);
    return outcome.exit_code != lab::kOk ? outcome.exit_code
           : lab::interrupted            ? 128 + lab::interrupted
                                         : lab::kOk;
  });
}

}  // namespace

int main(int argc, char** argv) {
  return lab::run_program("lab-solo", [&] { return run(argc, argv); });
}
