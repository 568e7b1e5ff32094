#include "wire/protocol/step_record.h"

#include <lab/event_t.hpp>
#include <lab/input_t.hpp>

#include "core/util/big_endian.h"
#include "wire/protocol/log_hash.h"
#include "wire/schema/codec.h"

namespace lab {
namespace {

bool assign(Bytes& place, std::span<const uint8_t> bytes, bool replace) {
  if (!place.empty() && !replace) return false;
  place.assign(bytes.begin(), bytes.end());
  return true;
}

}  // namespace

int64_t peek_utime(std::span<const uint8_t> message) { return load_big_endian<int64_t>(message.data() + 8); }
int64_t peek_run(std::span<const uint8_t> message) { return load_big_endian<int64_t>(message.data() + 16); }
int64_t peek_step(std::span<const uint8_t> message) { return load_big_endian<int64_t>(message.data() + 24); }
int64_t peek_digest(std::span<const uint8_t> robot_state) {
  return load_big_endian<int64_t>(robot_state.data() + robot_state.size() - 12);
}
int32_t peek_extras(std::span<const uint8_t> main_message) {
  return load_big_endian<int32_t>(main_message.data() + main_message.size() - 4);
}

void StepRecord::clear(int64_t new_step) {
  step = new_step;
  inputs.clear();
  state.clear();
  reference.clear();
  command.clear();
  events.clear();
}

bool StepRecord::store(Channel channel, std::span<const uint8_t> bytes, bool replace) {
  switch (channel) {
    case Channel::RobotState:
      return assign(state, bytes, replace);
    case Channel::Reference:
      return assign(reference, bytes, replace);
    case Channel::Command:
      return assign(command, bytes, replace);
    case Channel::Input:
      return assign(inputs[decode<input_t>(bytes).input_seq], bytes, replace);
    case Channel::Event: {
      const auto event = decode<event_t>(bytes);
      return assign(events[{event.process, event.index}], bytes, replace);
    }
    default:
      return false;
  }
}

const Bytes* StepRecord::main_of(const std::string& process) const {
  if (process == kSimulator) return &state;
  if (process == kPlanner) return &reference;
  if (process == kController) return &command;
  return nullptr;
}

int64_t StepRecord::extras_of(const std::string& process) const {
  int64_t count = process == kSimulator ? static_cast<int64_t>(inputs.size()) : 0;
  for (const auto& [key, bytes] : events) count += key.first == process;
  return count;
}

bool StepRecord::closed_by(const std::string& process) const {
  const Bytes* main = main_of(process);
  return !main->empty() && extras_of(process) >= peek_extras(*main);
}

bool StepRecord::complete(bool with_command) const {
  return closed_by(kSimulator) && closed_by(kPlanner) && (!with_command || closed_by(kController));
}

void StepRecord::trim() {
  std::erase_if(events, [&](const auto& entry) {
    const auto& [process, index] = entry.first;
    const Bytes* main = main_of(process);
    if (!main || main->empty()) return true;
    const int64_t others = process == kSimulator ? static_cast<int64_t>(inputs.size()) : 0;
    return index < 0 || index >= peek_extras(*main) - others;
  });
}

int64_t StepRecord::digest() const {
  static thread_local LogHash hash;
  hash.reset();
  in_order([](Channel channel, const Bytes& bytes) { hash.add(channel, bytes); });
  return hash.value();
}

}  // namespace lab
