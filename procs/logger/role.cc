#include "procs/logger/role.h"

#include "lab/run/run.h"

namespace lab::logger {

std::unique_ptr<Role> make_role(LoggerConfig config, LogSink& sink, Publish publish) {
  const BeginRun begin = [](const run_t& message) { return setup_of(open_run(message)); };
  return std::make_unique<LoggerRole>(config, begin, type_messages, sink, std::move(publish));
}

}  // namespace lab::logger
