#include <fmt/format.h>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "lab/experiment/experiment_yaml.h"
#include "lab/run/shell.h"
#include "procs/simulator/role.h"
#include "wire/protocol/lateness.h"

namespace {

int run(int argc, char** argv) {
  lab::CommandLine line("lab-simulator",
                        "The simulator of a lab: publishes RUN, waits for the other processes, and leads the "
                        "run step by step.");
  line.footer("example: lab-simulator --experiment runs/latest/experiment.yaml");
  lab::ParticipantOptions options{
      .name = lab::kSimulator,
      .url = "",
      .prefix = "",
      .channels = {lab::Channel::Reference, lab::Channel::Command, lab::Channel::Event, lab::Channel::Ack,
                   lab::Channel::Need, lab::Channel::Process, lab::Channel::Request}};
  std::string experiment_file, run_dir;
  line.option("--experiment", experiment_file, "YAML file (default: the run folder's experiment.yaml)");
  line.option("--run-dir", run_dir, "the run's folder").env("LAB_RUN_DIR");
  lab::add_bus_options(line, options.url, options.prefix);
  if (const auto code = line.parse(argc, argv)) return *code;
  return lab::guarded_main("lab-simulator", [&] {
    if (experiment_file.empty())
      experiment_file = run_dir.empty() ? "experiment.yaml" : run_dir + "/experiment.yaml";
    const lab::Experiment experiment = lab::load_experiment(experiment_file);
    const lab::Robot robot = lab::load_robot(experiment);
    lab::Participant participant(options);
    const auto role =
        lab::simulator::make_role(experiment, robot, lab::launch_nonce(), participant.publish());
    int code = participant.run(*role);
    if (code == lab::kOk && role->restart_requested()) code = lab::kAgain;
    const double seconds = static_cast<double>(role->running_time()) * 1e-6;
    if (role->step() > 0 && seconds > 0)
      lab::emit("{} steps in {:.6f} s, {:.0f} steps/s\n", role->step(), seconds,
                static_cast<double>(role->step()) / seconds);
    if (const lab::Lateness* late = role->lateness(); late && late->ticks() > 0)
      lab::emit("ticks late by {} us (p50), {} us (p99), {} us at most; {} overruns\n", late->quantile(0.5),
                late->quantile(0.99), late->longest(), role->overruns());
    return code;
  });
}

}  // namespace

int main(int argc, char** argv) {
  return lab::run_program("lab-simulator", [&] { return run(argc, argv); });
}
