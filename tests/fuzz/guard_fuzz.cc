// Whatever bytes come in on one of the lab's channels: the guard refuses them with a reason, or the generated decoder
// takes them, encodes them to the same bytes, and the schema's own decoder agrees. First byte: the channel.
#include <lab/ack_t.hpp>
#include <lab/check_t.hpp>
#include <lab/command_t.hpp>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/frame_t.hpp>
#include <lab/input_t.hpp>
#include <lab/need_t.hpp>
#include <lab/process_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/reply_t.hpp>
#include <lab/request_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <lab/type_t.hpp>

#include "tests/fuzz/fuzz.h"
#include "wire/schema/codec.h"
#include "wire/schema/guard.h"

namespace lab::fuzz {
namespace {

/// Calls f with a message of the channel's type.
template <class F>
void with_type(Channel channel, F&& f) {
  switch (channel) {
    case Channel::Run:
      return f(run_t{});
    case Channel::Type:
      return f(type_t{});
    case Channel::RobotState:
      return f(robot_state_t{});
    case Channel::Reference:
      return f(reference_t{});
    case Channel::Command:
      return f(command_t{});
    case Channel::Request:
      return f(request_t{});
    case Channel::Reply:
      return f(reply_t{});
    case Channel::Input:
      return f(input_t{});
    case Channel::Event:
      return f(event_t{});
    case Channel::End:
      return f(end_t{});
    case Channel::Ack:
      return f(ack_t{});
    case Channel::Need:
      return f(need_t{});
    case Channel::Process:
      return f(process_t{});
    case Channel::Frame:
      return f(frame_t{});
    case Channel::Check:
      return f(check_t{});
  }
}

}  // namespace

std::vector<std::vector<uint8_t>> seeds() {
  std::vector<std::vector<uint8_t>> all;
  const auto add = [&](Channel channel, const auto& message) {
    all.push_back(encode(message));
    all.back().insert(all.back().begin(), static_cast<uint8_t>(channel));
  };
  for (const ChannelRow& channel : kChannelTable)
    with_type(channel.id, [&](const auto& message) { add(channel.id, message); });
  robot_state_t state{};
  state.run = 7, state.nq = state.nv = 2, state.q = state.v = state.tau = {0.25, -1e300};
  add(Channel::RobotState, state);
  run_t run{};
  run.run = 7, run.nq = run.nv = run.njoints = 2, run.joint_names = {"a", "b"},
  run.experiment = "robot: {}\n", run.urdf = "<robot/>";
  add(Channel::Run, run);
  request_t request{};
  request.sender = "me", request.action.verb = "goal", request.action.n = 2, request.action.values = {1, 2};
  add(Channel::Request, request);
  return all;
}

}  // namespace lab::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  using namespace lab;
  if (size == 0) return 0;
  const Channel channel = static_cast<Channel>(bytes[0] % kChannels);
  const std::span<const uint8_t> data(bytes + 1, size - 1);
  Guard open, narrow;
  narrow.set_run(7), narrow.set_sizes(2, 2);
  const Verdict verdict = open.check(channel, data), strict = narrow.check(channel, data);
  fuzz::demand(strict.kind != Verdict::Refused || !strict.reason.empty(), "refused without a reason");
  fuzz::demand(verdict || !strict, "sizes and run make the guard milder");
  if (!verdict) {
    fuzz::demand(!verdict.reason.empty(), "refused without a reason");
    return 0;
  }
  fuzz::with_type(channel, [&](auto message) {
    decode(data, message);
    const auto again = encode(message);
    fuzz::demand(std::equal(again.begin(), again.end(), data.begin(), data.end()),
                 "decoded and encoded, it is another message");
    fuzz::demand(message.utime == verdict.head.utime && message.run == verdict.head.run &&
                     message.step == verdict.head.step,
                 "another head");
  });
  const Schema& schema = lab_schema();
  const Value value = schema.decode(*schema.find(row(channel).type), data);
  fuzz::demand(value.at("utime") && value.at("utime")->number() == static_cast<double>(verdict.head.utime),
               "the schema decodes another utime");
  return 0;
}
