#pragma once
#include <cmath>
#include <deque>
#include <lab/process_t.hpp>
#include <lab/request_t.hpp>
#include <lab/run_t.hpp>
#include <map>
#include <memory>
#include <queue>
#include <random>
#include <string>
#include <vector>

#include "wire/protocol/controller_role.h"
#include "wire/protocol/convert.h"
#include "wire/protocol/lockstep_simulator.h"
#include "wire/protocol/logger_role.h"
#include "wire/protocol/planner_role.h"
#include "wire/schema/codec.h"

/// A whole lockstep run in one thread on a bus that loses, doubles and delays messages, by a seed; processes are
/// stopped and started again. The robot is a toy whose arithmetic is enough to show any wrong or missing input.
namespace lab::test {

struct Weather {
  double loss = 0, twice = 0;
  Micros longest_delay = 100;
  double crash = 0;   ///< chance per 10 ms that planner, controller or logger is killed and started again
  double freeze = 0;  ///< chance per 10 ms that any process stands still for up to 50 ms
  int requests = 0;   ///< how many REQUESTs a person sends
};

struct Logged {
  Channel channel;
  Bytes bytes;
  bool operator==(const Logged&) const = default;
};

inline RunSetup toy_setup(const run_t& run) {
  return {run.model_hash, run.nq, run.nv, 0.01, 40 + run.seed % 60, run.seed % 7, 1 + run.seed % 3};
}

struct ToySimulator {
  Eigen::Vector2d q{0.1, -0.2}, v{0, 0}, tau{0, 0};
  StepResult operator()(int64_t step, const Command* command, std::span<const Action> actions) {
    if (command) tau = command->tau;
    for (const Action& action : actions) v[0] += action.values.at(0);
    if (step > 0) {
      v += 0.01 * tau;
      q += 0.01 * v;
    }
    StepResult out{
        {step, 0.01 * static_cast<double>(step), q, v, step ? Eigen::Vector2d(tau) : Eigen::Vector2d::Zero()},
        {},
        ""};
    if (step % 5 == 2) out.events.push_back({"tick", "toy", std::to_string(q[0])});
    return out;
  }
};
struct ToyPlanner {
  double offset = 0;
  Reference operator()(int64_t step, const PlanInput& input, std::vector<Event>& events) {
    for (const Action& action : input.actions) offset += action.values.at(0);
    if (step % 11 == 3) {
      events.push_back({"mark", "plan", std::to_string(offset)});
      events.push_back({"mark", "again", ""});
    }
    return {step, Eigen::Vector2d(std::sin(0.03 * static_cast<double>(step)) + offset, offset),
            Eigen::Vector2d::Zero(), Eigen::Vector2d::Zero()};
  }
};
struct ToyController {
  double gain = 20, integral = 0;  // a state, so that a wrong fold shows
  Command operator()(const RobotState& state, const Reference& reference, std::span<const Action> actions,
                     std::vector<Event>& events) {
    for (const Action& action : actions) gain += action.values.at(0);
    const Eigen::Vector2d e = reference.q - state.q;
    integral += 0.01 * e[0];
    if (e[0] > 0.05) events.push_back({"far", "toy", std::to_string(e[0])});
    return {gain * e - 4 * state.v + Eigen::Vector2d(integral, 0)};
  }
};

/// A log that outlives the recorder; what was not flushed is lost with it.
struct MemoryLog {
  std::vector<Logged> kept;
  std::vector<Logged> unflushed;
  bool closed = false;
};
class MemorySink : public LogSink {
 public:
  explicit MemorySink(MemoryLog& log) : log_(log) { log_.unflushed.clear(); }
  void open(int64_t, LogKind, const std::function<void(Channel, std::span<const uint8_t>)>& visit) override {
    for (const Logged& entry : log_.kept) visit(entry.channel, entry.bytes);
  }
  void append(Channel channel, std::span<const uint8_t> bytes, int64_t) override {
    log_.unflushed.push_back({channel, {bytes.begin(), bytes.end()}});
  }
  void flush() override {
    log_.kept.insert(log_.kept.end(), log_.unflushed.begin(), log_.unflushed.end());
    log_.unflushed.clear();
  }
  void close() override { flush(), log_.closed = true; }
  void telemetry(Channel, std::span<const uint8_t>) override {}

 private:
  MemoryLog& log_;
};

class World {
 public:
  World(uint64_t seed, Weather weather) : weather_(weather), random_(seed) {
    run_.run = 4711;
    run_.step = -1;
    run_.model_hash = 99;
    run_.seed = static_cast<int64_t>(seed % 1000);
    run_.nq = run_.nv = run_.njoints = 2;
    run_.joint_names = {"a", "b"};
    names_ = {kSimulator, kPlanner, kController, kLogger};
    std::shuffle(names_.begin(), names_.end(), random_);
    for (const auto& name : names_) start(name, random(20'000));
  }

  /// Runs until the simulator is done; false if it is not after `limit` of its own time.
  bool run(Micros limit = 120'000'000) {
    while (now_ < limit) {
      if (now_ >= next_mishap_) mishaps();
      deliver();
      for (auto act = acts_.begin(); act != acts_.end() && act->first <= nodes_[kSimulator].role->step();
           act = acts_.erase(act))
        act->second();
      for (const auto& name : names_) tend(name);
      const auto& simulator = nodes_[kSimulator];
      if (simulator.role->outcome().ended) return true;
      now_ = std::max(now_ + 1, next_time());
    }
    return false;
  }
  const Outcome& outcome(const std::string& name) { return nodes_[name].role->outcome(); }
  Role& role(const std::string& name) { return *nodes_[name].role; }
  const MemoryLog& log() const { return log_; }
  const run_t& run_message() const { return run_; }
  /// From now on this process neither hears nor speaks.
  void freeze_for_good(const std::string& name) { nodes_[name].asleep_until = INT64_MAX; }
  void at_step(int64_t step, std::function<void()> act) { acts_.emplace(step, std::move(act)); }
  int crashes() const { return crashes_; }
  int64_t sent() const { return sent_; }
  std::string last_reply;

 private:
  struct Node {
    std::unique_ptr<Role> role;
    std::unique_ptr<MemorySink> sink;
    Micros asleep_until = 0, next_process = 0;
    int32_t pid = 0;
    std::string said;
  };
  struct Flying {
    Micros due;
    int64_t order;
    std::string to;
    int32_t to_pid;
    Channel channel;
    Bytes bytes;
    bool operator<(const Flying& other) const {
      return std::pair(due, order) > std::pair(other.due, other.order);
    }
  };

  int64_t random(int64_t below) { return std::uniform_int_distribution<int64_t>(0, below - 1)(random_); }
  bool chance(double p) { return std::uniform_real_distribution<double>(0, 1)(random_) < p; }

  void start(const std::string& name, Micros asleep) {
    Node& node = nodes_[name];
    node.role.reset();
    node.pid = ++last_pid_;
    node.asleep_until = now_ + asleep;
    node.next_process = 0;
    node.said.clear();
    const Publish publish = [this, name](Channel channel, std::span<const uint8_t> bytes) {
      send(name, channel, bytes);
    };
    const ReadLog read_log = [this](int64_t,
                                    const std::function<void(Channel, std::span<const uint8_t>)>& visit) {
      for (const Logged& entry : std::vector<Logged>(log_.kept)) visit(entry.channel, entry.bytes);
    };
    const RunSetup setup = toy_setup(run_);
    if (name == kSimulator) {
      SimulatorConfig config;
      config.run = encode(run_);
      config.run_id = run_.run;
      config.model_hash = run_.model_hash;
      config.nq = config.nv = 2;
      config.dt = setup.dt;
      config.last_step = setup.last_step;
      config.every = setup.every;
      config.lead = setup.lead;
      node.role = std::make_unique<LockstepSimulatorRole>(config, ToySimulator(), publish);
    } else if (name == kPlanner) {
      node.role = std::make_unique<PlannerRole>(FollowerConfig{10'000'000, 10'000'000, read_log}, toy_setup,
                                                ToyPlanner(), publish);
    } else if (name == kController) {
      node.role = std::make_unique<ControllerRole>(FollowerConfig{10'000'000, 10'000'000, read_log},
                                                   toy_setup, ToyController(), publish);
    } else {
      node.sink = std::make_unique<MemorySink>(log_);
      node.role = std::make_unique<LoggerRole>(
          LoggerConfig{}, toy_setup, [](int64_t) { return std::vector<Bytes>{}; }, *node.sink, publish);
    }
  }

  void send(const std::string& from, Channel channel, std::span<const uint8_t> bytes) {
    ++sent_;
    for (const auto& [name, node] : nodes_) {
      if (name == from) continue;
      for (int copies = 1 + chance(weather_.twice); copies > 0; --copies)
        if (!chance(weather_.loss))
          flying_.push({now_ + 10 + random(weather_.longest_delay),
                        ++order_,
                        name,
                        node.pid,
                        channel,
                        {bytes.begin(), bytes.end()}});
    }
  }

  /// When something can happen next.
  Micros next_time() {
    Micros next = next_mishap_;
    if (!flying_.empty()) next = std::min(next, flying_.top().due);
    for (const auto& name : names_) {
      const Node& node = nodes_[name];
      if (node.role->outcome().ended) continue;
      next = std::min(next, std::max(node.asleep_until, std::min(node.role->wake(), node.next_process)));
    }
    return next;
  }

  void deliver() {
    std::vector<Flying> late;
    while (!flying_.empty() && flying_.top().due <= now_) {
      Flying message = flying_.top();
      flying_.pop();
      if (message.to == "person") {
        if (message.channel == Channel::Reply) answered_ = true;
        continue;
      }
      Node& node = nodes_[message.to];
      if (node.pid != message.to_pid) continue;  // it died with its socket
      if (node.asleep_until > now_)
        late.push_back(std::move(message));
      else if (!node.role->outcome().ended)
        node.role->receive(message.channel, message.bytes, now_);
    }
    for (auto& message : late) {
      message.due = nodes_[message.to].asleep_until;
      flying_.push(std::move(message));
    }
  }

  void tend(const std::string& name) {
    Node& node = nodes_[name];
    if (node.asleep_until > now_ || node.role->outcome().ended) return;
    node.role->tick(now_);
    if (node.role->state() == node.said && now_ < node.next_process) return;
    node.said = node.role->state();
    node.next_process = now_ + kRepeat;
    process_t process{};
    process.utime = now_;
    process.run = node.role->run();
    process.step = node.role->step();
    process.name = name;
    process.pid = node.pid;
    process.state = node.said;
    process.model_hash = node.role->model_hash();
    send(name, Channel::Process, encode(process));
  }

  void mishaps() {
    next_mishap_ = now_ + 10'000;
    const int64_t step = nodes_[kSimulator].role->step();
    if (step >= 0 && !log_.closed)
      for (const char* name : {kPlanner, kController, kLogger})
        if (chance(weather_.crash)) {
          ++crashes_;
          start(name, 1'000 + random(40'000));
        }
    for (auto& [name, node] : nodes_)
      if (chance(weather_.freeze) && node.asleep_until < now_) node.asleep_until = now_ + random(50'000);
    if (step >= 0 && asked_ < weather_.requests && chance(0.5)) {
      answered_ = false;
      ++asked_;
    }
    if (asked_ > 0 && !answered_) {  // repeated until it is answered
      request_t request{};
      request.step = -1;
      request.sender = "person";
      request.id = asked_;
      request.action.verb = "set";
      request.action.values = {0.25 * asked_};
      request.action.n = 1;
      nodes_["person"];
      send("person", Channel::Request, encode(request));
    }
  }

  Weather weather_;
  std::mt19937_64 random_;
  run_t run_{};
  std::vector<std::string> names_;
  std::map<std::string, Node> nodes_;
  std::priority_queue<Flying> flying_;
  MemoryLog log_;
  std::multimap<int64_t, std::function<void()>> acts_;
  Micros now_ = 0, next_mishap_ = 0;
  int64_t order_ = 0, sent_ = 0;
  int32_t last_pid_ = 100;
  int crashes_ = 0, asked_ = 0;
  bool answered_ = true;
};

}  // namespace lab::test
