#include "procs/solo/solo.h"

#include <array>
#include <lab/process_t.hpp>

#include "procs/controller/role.h"
#include "procs/logger/role.h"
#include "procs/planner/role.h"
#include "procs/simulator/role.h"
#include "procs/solo/memory_bus.h"
#include "wire/schema/codec.h"

namespace lab::solo {
namespace {

Bytes ready(const char* name, int32_t pid, const Role& role) {
  process_t process{};
  process.run = role.run();
  process.step = role.step();
  process.name = name;
  process.pid = pid;
  process.state = role.state();
  process.model_hash = role.model_hash();
  return encode(process);
}

}  // namespace

Outcome run(const Experiment& experiment, const Robot& robot, LogSink& sink,
            const std::function<bool(int64_t)>& keep_going) {
  MemoryBus bus;
  const auto planner = planner::make_role({}, bus.publish());
  bus.add(*planner);
  const auto controller = controller::make_role({}, bus.publish());
  bus.add(*controller);
  LoggerConfig recorder;
  recorder.every = experiment.logger.every;
  const auto logger = logger::make_role(recorder, sink, bus.publish());
  bus.add(*logger);
  const auto simulator = simulator::make_role(experiment, robot, 0, bus.publish());
  bus.add(*simulator);

  const Role& leader = *simulator;
  const std::array<Role*, 3> followers{planner.get(), controller.get(), logger.get()};
  Micros now = 0;
  simulator->tick(now);  // publishes RUN
  bus.deliver(leader, now, 100);
  for (const Role* role : followers)
    if (role->outcome().ended) return role->outcome();
  simulator->receive(Channel::Process, ready(kPlanner, 1, *planner), now);
  simulator->receive(Channel::Process, ready(kController, 2, *controller), now);
  simulator->receive(Channel::Process, ready(kLogger, 3, *logger), now);
  bool stopping = false;
  while (!leader.outcome().ended) {
    bus.deliver(leader, now, 1000);
    for (const Role* role : followers)
      if (role->outcome().exit_code != kOk) return role->outcome();
    if (!stopping && !keep_going(leader.step())) {
      stopping = true;
      simulator->stop(now);
    }
    if (!bus.idle()) continue;
    now += kRepeat;  // the queue is empty: let timers expire
    for (Role* role : followers) role->tick(now);
    simulator->tick(now);
  }
  return leader.outcome();
}

}  // namespace lab::solo
