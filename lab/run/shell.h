// The common part of the mains of all processes.
#pragma once
#include <functional>
#include <memory>
#include <string>

#include "core/util/command_line.h"
#include "wire/process/participant.h"
#include "wire/protocol/follower.h"

namespace lab {

/// Runs `work` and turns what it throws into one line on stderr and an exit code: ExperimentError 3, BusError 7,
/// anything else 1. Inside run_program (core/util/console.h), which every main begins with.
int guarded_main(const std::string& program, const std::function<int()>& work);

/// --url and --prefix.
void add_bus_options(CommandLine&, std::string& url, std::string& prefix, const char* url_names = "-l,--url");
/// --deadline and --ready: how long a process waits for the simulator.
void add_waits(CommandLine&, double& deadline, double& ready);

/// The whole main of a process that follows the simulator, run_program included: parses --run-dir, --url, --prefix, --deadline, --ready.
int follower_main(int argc, char** argv, const std::string& name,
                  const std::function<std::unique_ptr<Role>(FollowerConfig, Publish)>& make_role);

}  // namespace lab
