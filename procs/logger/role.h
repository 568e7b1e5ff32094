// The logger in the protocol, with its files.
#pragma once
#include <memory>

#include "wire/protocol/logger_role.h"

namespace lab::logger {

/// A logger that reads the sizes of the robot from RUN.
std::unique_ptr<Role> make_role(LoggerConfig config, LogSink& sink, Publish publish);

}  // namespace lab::logger
