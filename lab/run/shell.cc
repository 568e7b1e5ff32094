#include "lab/run/shell.h"

#include <fmt/format.h>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "lab/experiment/experiment.h"
#include "lab/run/run.h"

namespace lab {

int guarded_main(const std::string& program, const std::function<int()>& work) {
  try {
    return work();
  } catch (const ExperimentError& error) {
    return refuse(program, error.what(), kBadConfig);
  } catch (const BusError& error) {
    return refuse(program, error.what(), kTransport);
  } catch (const std::exception& error) {
    return refuse(program, error.what(), kCheckFailed);
  }
}

void add_bus_options(CommandLine& line, std::string& url, std::string& prefix, const char* url_names) {
  line.option(url_names, url, "LCM URL (default: env LCM_DEFAULT_URL)");
  line.option("--prefix", prefix, "of channel names, where several robots share a bus").env("LAB_PREFIX");
}

void add_waits(CommandLine& line, double& deadline, double& ready) {
  line.option("--deadline", deadline, "s without a message from the simulator that end the process")
      .positive();
  line.option("--ready", ready, "s to wait for RUN").positive();
}

namespace {

using MakeRole = std::function<std::unique_ptr<Role>(FollowerConfig, Publish)>;

int follow(int argc, char** argv, const std::string& name, const MakeRole& make_role) {
  CommandLine line(
      "lab-" + name,
      fmt::format("The {} of a lab: waits for RUN on the bus and follows the simulator to the end.", name));
  line.footer(fmt::format("example: lab-{} --run-dir runs/latest", name));
  ParticipantOptions options{.name = name,
                             .url = "",
                             .prefix = "",
                             .channels = {Channel::Run, Channel::RobotState, Channel::Input, Channel::Need,
                                          Channel::End, Channel::Process}};
  if (name == kController) options.channels.push_back(Channel::Reference);
  std::string run_dir;
  double deadline = 10, ready = 10;
  line.option("--run-dir", run_dir, "the run's folder: lets a restarted process catch up from its log")
      .env("LAB_RUN_DIR");
  add_bus_options(line, options.url, options.prefix);
  add_waits(line, deadline, ready);
  if (const auto code = line.parse(argc, argv)) return *code;
  return guarded_main("lab-" + name, [&] {
    Participant participant(options);
    FollowerConfig config;
    config.deadline = std::llround(deadline * 1e6);
    config.ready_deadline = std::llround(ready * 1e6);
    if (!run_dir.empty()) config.read_log = log_reader(run_dir + "/log.lcm");
    const auto role = make_role(std::move(config), participant.publish());
    return participant.run(*role);
  });
}

}  // namespace

int follower_main(int argc, char** argv, const std::string& name, const MakeRole& make_role) {
  return run_program("lab-" + name, [&] { return follow(argc, argv, name, make_role); });
}

}  // namespace lab
