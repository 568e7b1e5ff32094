#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "procs/experiment/experiment_yaml.h"
#include "procs/run/shell.h"
#include "procs/simulator/role.h"

int main(int argc, char** argv) {
  CLI::App app{"The simulator of a lab: publishes RUN, waits for the other processes, and leads the run step by step."};
  app.footer("example: lab-simulator --experiment runs/latest/experiment.yaml");
  lab::ParticipantOptions options{.name = lab::kSimulator, .url = "", .prefix = "", .channels = {lab::Channel::Reference, lab::Channel::Command, lab::Channel::Event, lab::Channel::Ack,
                                                            lab::Channel::Need, lab::Channel::Process, lab::Channel::Request}};
  std::string experiment_file, run_dir;
  app.add_option("--experiment", experiment_file, "YAML file")->required();
  app.add_option("--run-dir", run_dir, "the run's folder (not used by the simulator)");
  app.add_option("-l,--url", options.url, "LCM URL (default: env LCM_DEFAULT_URL)");
  app.add_option("--prefix", options.prefix, "of channel names, where several robots share a bus");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? lab::kOk : lab::kUsage;
  }
  return lab::guarded_main("lab-simulator", [&] {
    const lab::Experiment experiment = lab::load_experiment(experiment_file);
    const lab::Robot robot = lab::load_robot(experiment);
    lab::Participant participant(options);
    const auto role = lab::simulator::make_role(experiment, robot, lab::launch_nonce(), participant.publish());
    const int code = participant.run(*role);
    const double seconds = static_cast<double>(role->running_time()) * 1e-6;
    if (role->step() > 0 && seconds > 0)
      fmt::print("{} steps in {:.6f} s, {:.0f} steps/s\n", role->step(), seconds, static_cast<double>(role->step()) / seconds);
    return code;
  });
}
