#pragma once
#include <memory>

#include "wire/protocol/recorder.h"

namespace lab::logger {

/// The recorder of a lockstep run that reads its sizes from RUN.
std::unique_ptr<Role> make_role(RecorderConfig config, LogSink& sink, Publish publish);

}  // namespace lab::logger
