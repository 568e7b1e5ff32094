// The other side of `lab bench loop`: the loop as one writes it with plain liblcm, without logger, guard or repair.
// Three processes in a ring, simulator -> planner -> controller -> simulator, pass one message a step.
//
// usage: bench-liblcm-ring STEPS   (URL from LCM_DEFAULT_URL); prints `steps seconds`
#include <lcm/lcm.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <lab/command_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/robot_state_t.hpp>
#include <vector>

namespace {

constexpr int kJoints = 7;

double now() {
  timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

template <class Message>
void publish(lcm_t* lcm, const char* channel, const Message& message) {
  std::vector<uint8_t> bytes(message.getEncodedSize());
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  lcm_publish(lcm, channel, bytes.data(), static_cast<unsigned>(bytes.size()));
}

/// Hands every message of a channel, decoded, to `handle`.
template <class Message, class Handle>
struct Subscription {
  Subscription(lcm_t* lcm, const char* channel, Handle handle) : handle_(std::move(handle)) {
    lcm_subscribe(
        lcm, channel,
        [](const lcm_recv_buf_t* buffer, const char*, void* self) {
          Message message;
          if (message.decode(buffer->data, 0, static_cast<int>(buffer->data_size)) > 0)
            static_cast<Subscription*>(self)->handle_(message);
        },
        this);
  }
  Handle handle_;
};

lcm_t* open_lcm() {
  lcm_t* lcm = lcm_create(nullptr);
  if (!lcm) std::exit(7);
  return lcm;
}

lab::robot_state_t state_message() {
  lab::robot_state_t state{};
  state.nq = state.nv = kJoints;
  for (auto* x : {&state.q, &state.v, &state.tau}) x->assign(kJoints, 0);
  return state;
}

[[noreturn]] void planner() {
  lcm_t* lcm = open_lcm();
  Subscription<lab::robot_state_t, std::function<void(const lab::robot_state_t&)>> states(
      lcm, "ROBOT_STATE", [&](const auto& state) {
        lab::reference_t reference{};
        reference.step = state.step;
        reference.nq = reference.nv = kJoints;
        reference.q = state.q;
        reference.v = reference.a = state.v;
        publish(lcm, "REFERENCE", reference);
      });
  for (;;) lcm_handle(lcm);
}

[[noreturn]] void controller() {
  lcm_t* lcm = open_lcm();
  Subscription<lab::reference_t, std::function<void(const lab::reference_t&)>> references(
      lcm, "REFERENCE", [&](const auto& reference) {
        lab::command_t command{};
        command.step = reference.step;
        command.nv = kJoints;
        command.tau = reference.a;
        publish(lcm, "COMMAND", command);
      });
  for (;;) lcm_handle(lcm);
}

pid_t start(void (*body)()) {
  const pid_t pid = fork();
  if (pid != 0) return pid;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  body();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  const int64_t steps = argc > 1 ? std::atoll(argv[1]) : 10000;
  const pid_t others[2] = {start([] { planner(); }), start([] { controller(); })};
  lcm_t* lcm = open_lcm();
  int64_t answered = -1;
  Subscription<lab::command_t, std::function<void(const lab::command_t&)>> commands(
      lcm, "COMMAND", [&](const auto& command) { answered = std::max(answered, command.step); });
  lab::robot_state_t state = state_message();
  double begin = 0;
  int64_t timed = 0;
  for (int64_t step = 0; step < steps; ++step) {
    if (step == steps / 10) {  // the first tenth warms up
      begin = now();
      timed = steps - step;
    }
    state.step = step;
    do {
      publish(lcm, "ROBOT_STATE", state);  // again after 100 ms: the others may still be starting
      while (answered < step && lcm_handle_timeout(lcm, 100) > 0) {
      }
    } while (answered < step);
  }
  std::printf("%lld %.6f\n", static_cast<long long>(timed), now() - begin);
  for (pid_t pid : others) {
    kill(pid, SIGKILL);
    waitpid(pid, nullptr, 0);
  }
}
