// A controller that stands in a lab controller's place and does one thing wrong, for the system tests:
//   plain        knows only ROBOT_STATE, COMMAND and PROCESS: always answers with zero effort
//   nan | short  at step 5 the effort holds a NaN, or one entry too few
//   silent       says nothing from step 5 on
//   other_model  is ready with another model
#include <unistd.h>

#include <lab/command_t.hpp>
#include <lab/process_t.hpp>
#include <lab/robot_state_t.hpp>
#include <limits>
#include <string>

#include "wire/bus/bus.h"
#include "wire/process/participant.h"

namespace {

template <class Message>
std::vector<uint8_t> bytes_of(const Message& message) {  // without the guard, on purpose
  std::vector<uint8_t> bytes(message.getEncodedSize());
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string mode = argc > 1 ? argv[1] : "plain";
  lab::BusOptions options;
  options.channels = {"ROBOT_STATE", "PROCESS", "END"};
  const auto bus = lab::open_bus("", options);
  lab::process_t me{};
  me.step = -1, me.name = "controller", me.pid = getpid(), me.state = "READY", me.nonce = lab::launch_nonce();
  bool ended = false;
  for (lab::Micros next = 0; !ended;) {
    if (const lab::Micros now = lab::monotonic_now(); now >= next) {
      me.utime = lab::wall_now(), next = now + 100'000;
      bus->publish("PROCESS", bytes_of(me));
    }
    bus->poll(50'000, [&](const lab::Datagram& datagram) {
      if (datagram.channel == "END") ended = true;
      if (datagram.channel == "PROCESS") {  // echo the simulator's run and model
        lab::process_t process;
        if (process.decode(datagram.data.data(), 0, static_cast<int>(datagram.data.size())) < 0 ||
            process.name != "simulator")
          return;
        me.run = process.run, me.model_hash = mode == "other_model" ? 0xdeadbeef : process.model_hash;
      }
      if (datagram.channel != "ROBOT_STATE") return;
      lab::robot_state_t state;
      if (state.decode(datagram.data.data(), 0, static_cast<int>(datagram.data.size())) < 0) return;
      if (mode == "silent" && state.step >= 5) return;
      lab::command_t command{};
      command.utime = state.utime, command.run = state.run;
      command.step = command.state_step = command.reference_step = state.step;
      command.input_seq = state.input_seq;
      command.nv = state.nv - (mode == "short" && state.step == 5);
      command.tau.assign(command.nv, 0.0);
      if (mode == "nan" && state.step == 5) command.tau[1] = std::numeric_limits<double>::quiet_NaN();
      bus->publish("COMMAND", bytes_of(command));
    });
  }
}
