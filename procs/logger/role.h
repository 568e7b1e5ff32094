#pragma once
#include <memory>

#include "wire/protocol/logger_role.h"

namespace lab::logger {

/// The recorder of a lockstep run that reads its sizes from RUN.
std::unique_ptr<Role> make_role(LoggerConfig config, LogSink& sink, Publish publish);

}  // namespace lab::logger
