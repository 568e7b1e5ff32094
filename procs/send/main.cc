// lab-send: sends one request to the simulator and prints the answer.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <cmath>
#include <lab/end_t.hpp>
#include <lab/event_t.hpp>
#include <lab/input_t.hpp>
#include <lab/reference_t.hpp>
#include <lab/request_t.hpp>
#include <lab/robot_state_t.hpp>
#include <lab/run_t.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/util/command_line.h"
#include "core/util/console.h"
#include "core/util/json_text.h"
#include "lab/run/run.h"
#include "lab/run/shell.h"
#include "procs/send/arrival.h"
#include "procs/send/guest.h"
#include "procs/send/send.h"
#include "wire/process/participant.h"
#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab::send {
namespace {

using nlohmann::ordered_json;

std::string sender() {
  char host[256] = {};
  gethostname(host, sizeof host - 1);
  return fmt::format("lab-send@{}:{}:{}", host, getpid(), wall_now());
}

/// Mimic joints of a run's robot, each with the joint that it follows in the end.
std::map<std::string, std::string> followers_of(const run_t& run) {
  std::map<std::string, std::string> out;
  const rbd::Model model = open_run(run).robot.model;
  for (int joint = 1; joint < model.njoints; ++joint) {
    int leader = joint;
    while (model.mimic(leader).leader >= 0) leader = model.mimic(leader).leader;
    if (leader != joint) out[model.names[joint]] = model.names[leader];
  }
  return out;
}

/// Receives RUN and the current reference of the joints.
bool read_run_and_reference(Guest& guest, run_t& known, std::vector<double>& current) {
  int64_t run = 0;
  return guest.ask(Channel::Need, guest.ask_for_run(), [&](Channel channel, std::span<const uint8_t> bytes) {
    if (channel == Channel::Run) {
      known = decode<run_t>(bytes);
      run = known.run;
    } else if (channel == Channel::Reference && run != 0) {
      const auto message = decode<reference_t>(bytes);
      if (message.run == run) current = message.q;
    }
    return run != 0 && !current.empty();
  });
}

/// The words of the command line.
struct Words {
  std::vector<std::string> list;  ///< of goal and push
  std::string target, assignment, mass, com;
  Place place;
  double duration = 0, seconds = 0.1;
  int64_t count = 1;
  bool wait = false;
};

struct Asked {
  request_t request{};
  reply_t reply{};
  bool answered = false;  ///< reply is the simulator's
};

Asked ask(Guest& guest, const Action& action) {
  Asked asked;
  request_t& message = asked.request;
  message.run = guest.run();
  message.step = -1;
  message.utime = wall_now();
  message.sender = sender();
  message.id = 1;
  message.action = to_message(action);
  guest.ask(Channel::Request, encode(message), [&](Channel channel, std::span<const uint8_t> bytes) {
    if (channel != Channel::Reply) return false;
    auto answer = decode<reply_t>(bytes);
    if (answer.sender != message.sender || answer.id != message.id) return false;
    asked.reply = std::move(answer);
    return asked.answered = true;
  });
  return asked;
}

ordered_json to_json(const Action& action, const reply_t& reply) {
  return {{"verb", action.verb}, {"confirmed", true},
          {"ok", reply.ok != 0}, {"reason", reply.reason},
          {"step", reply.step},  {"run", fmt::format("{:016x}", static_cast<uint64_t>(reply.run))}};
}

/// Says that there is no answer, or that it is no. Returns the exit code; 0 if the request was accepted.
int refusal(const Options& options, const Action& action, const Asked& asked) {
  if (interrupted) return 128 + interrupted;
  if (asked.answered && asked.reply.ok) return kOk;
  if (options.as_json)
    emit("{}\n", json_text(asked.answered ? to_json(action, asked.reply)
                                          : ordered_json{{"verb", action.verb}, {"confirmed", false}}));
  if (asked.answered)
    complain("lab-send", told(action, asked.reply));
  else
    complain("lab-send",
             fmt::format("{} unconfirmed: no answer in {:g} s; see the log", action.verb, options.timeout));
  return kTransport;
}

int request(Guest& guest, const Options& options, const Action& action) {
  const Asked asked = ask(guest, action);
  if (const int code = refusal(options, action, asked)) return code;
  emit("{}\n", options.as_json ? json_text(to_json(action, asked.reply)) : told(action, asked.reply));
  return kOk;
}

/// Sends a goal and waits until the robot is there: 0; or will not be: 1.
int request_and_wait(Guest& guest, const Options& options, const Action& action, const run_t& known) {
  constexpr Micros kSilence = 5'000'000;  // a run that ended without a word, or is paused
  const RunView run = open_run(known);
  const Asked asked = ask(guest, action);
  if (const int code = refusal(options, action, asked)) return code;
  Arrival arrival(run.experiment, run.robot.model, action, asked.reply.step);
  const auto take = [&](Channel channel, std::span<const uint8_t> bytes) {
    if (channel == Channel::Reference) arrival.see(to_signal(decode<reference_t>(bytes)));
    if (channel == Channel::RobotState) arrival.see(to_signal(decode<robot_state_t>(bytes)));
    if (channel == Channel::End) arrival.give_up("the run has ended");
    if (channel == Channel::Input)
      if (const auto input = decode<input_t>(bytes);
          input.step >= asked.reply.step &&
          (input.sender != asked.request.sender || input.id != asked.request.id))
        arrival.see(to_signal(input.action));
    if (channel == Channel::Event)
      if (const auto event = decode<event_t>(bytes);
          event.what == "action_ignored" && event.who == kPlanner && event.why.starts_with("'goal"))
        arrival.give_up(event.why);
    return arrival.over();
  };
  const Micros until = options.wait_seconds > 0
                           ? monotonic_now() + static_cast<Micros>(options.wait_seconds * 1e6)
                           : std::numeric_limits<Micros>::max();
  guest.listen(take, kSilence, until);
  if (interrupted) return 128 + interrupted;
  if (options.as_json) {
    ordered_json said = to_json(action, asked.reply);
    said["reached"] = arrival.reached();
    if (arrival.reached())
      said["reached_step"] = arrival.step();
    else
      said["reason"] = arrival.why_not();
    emit("{}\n", json_text(said));
  } else if (arrival.reached()) {
    emit("goal reached after {:.3f} s, at step {}\n", arrival.seconds(), arrival.step());
  }
  if (!arrival.reached()) complain("lab-send", "goal not reached: " + arrival.why_not());
  return arrival.reached() ? kOk : kCheckFailed;
}

/// Prints what is in force: lines "name<tab>value<tab>unit" of the simulator's answer, all or those of a process and key.
int get(Guest& guest, const Options& options, const Words& words) {
  const Action action = plain("get");
  const Asked asked = ask(guest, action);
  if (const int code = refusal(options, action, asked)) return code;
  const std::string wanted = words.target + (words.assignment.empty() ? "" : "." + words.assignment);
  ordered_json all = ordered_json::object();
  std::vector<std::string> names;
  for (const Setting& setting : settings_of(asked.reply.reason)) {
    names.push_back(setting.name);
    if (!wanted.empty() && setting.name != wanted && !setting.name.starts_with(wanted + ".")) continue;
    all[setting.name] = {{"value", setting.value}, {"unit", setting.unit}};
    if (!options.as_json)
      emit("{}", words.assignment.empty() ? fmt::format("{:<28} {}{}{}\n", setting.name, setting.value,
                                                        setting.unit.empty() ? "" : " ", setting.unit)
                                          : setting.value + "\n");
  }
  if (all.empty())
    throw UsageError(fmt::format("get: there is no '{}'{} (there are {})", wanted,
                                 did_you_mean(wanted, names), list_of(names)));
  if (options.as_json) emit("{}\n", json_text(all, 2));
  return kOk;
}

int no_answer(const Options& options) {
  if (interrupted) return 128 + interrupted;
  return refuse("lab-send",
                fmt::format("no simulator answers in {:g} s; is a lab running here?", options.timeout),
                kTransport);
}

Option add_options(CommandLine& line, Options& options) {
  add_bus_options(line, options.url, options.prefix);
  line.option("--run-dir", options.run_dir, "the lab's folder: only its own simulator is asked")
      .env("LAB_RUN_DIR");
  line.option("--run", options.run, "only this run (hexadecimal), where several are on the bus")
      .check([](const std::string& word) {
        return !word.empty() && word.size() <= 16 &&
                       word.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos
                   ? ""
                   : "not a hexadecimal number";
      });
  line.flag("--json", options.as_json, "print JSON");
  line.options_behind_verbs();
  return line
      .option(
          "--timeout", options.timeout,
          "give up after so many s (default: 5 for the answer; a goal is waited for as long as states come)")
      .positive();
}

CommandLine add_verb(CommandLine& line, const char* name, const char* what, const char* example) {
  CommandLine sub = line.verb(name, what);
  sub.footer(std::string("example: lab-send ") + example);
  return sub;
}

void add_goal(CommandLine& line, Words& words) {
  CommandLine goal = add_verb(
      line, "goal",
      "Moves the reference to a configuration, or a frame to a pose, from where it is, without a jump.",
      "goal --frame effector_body --position 0.5,0.1,0.6 --rpy 0,1.57,0 --duration 2");
  const Option q =
      goal.option("q", words.list, "a number for every joint (rad, m), or JOINT=VALUE for some").many_words();
  const Option frame =
      goal.option("--frame", words.place.frame, "of the robot, to move to a pose in the world").excludes(q);
  const Option position = goal.option("--position", words.place.position, "x,y,z in m").needs(frame);
  const Option rpy = goal.option("--rpy", words.place.rpy, "roll,pitch,yaw in rad (default: any orientation)")
                         .needs(position);
  goal.option("--quaternion", words.place.quaternion, "x,y,z,w instead of --rpy")
      .needs(position)
      .excludes(rpy);
  goal.option("--duration", words.duration,
              "s (default: as fast as planner.speed, half, of the speed limits allows)");
  goal.flag("--wait", words.wait, "end with 0 when the robot is there, with 1 when it will not be");
  goal.options_between_words();
}

void add_verbs(CommandLine& line, Words& words) {
  add_goal(line, words);
  CommandLine set =
      add_verb(line, "set", "Changes a value of a process while it runs.", "set controller kp=80");
  set.option("process", words.target, "such as controller").required();
  set.option("assignment", words.assignment, "KEY=VALUE, or KEY=VALUE,VALUE.. for each joint").required();
  CommandLine get =
      add_verb(line, "get", "Prints what is in force: gains, motion, payloads.", "get controller kp");
  get.option("process", words.target, "such as controller (default: all)");
  get.option("key", words.assignment, "such as kp: only its value");
  CommandLine push =
      add_verb(line, "push", "Pushes a frame with a force (N) and a torque (Nm) in world axes.",
               "push effector_body 20 0 0 --for 0.2");
  push.option("frame", words.target, "of the robot").required();
  push.option("wrench", words.list, "FX FY FZ [NX NY NZ]").required().many_words();
  push.option("--for", words.seconds, "s (default 0.1)");
  push.options_between_words();
  CommandLine payload = add_verb(line, "payload",
                                 "Fixes a mass to a frame of the simulated robot, in place of what it "
                                 "carried; the controller does not know.",
                                 "payload effector_body 2 --com 0,0,0.1");
  payload.option("frame", words.target, "of the robot").required();
  payload.option("mass", words.mass, "kg; 0 takes it off").required();
  payload.option("--com", words.com, "x,y,z in the frame, m (default: at its origin)");
  add_verb(line, "estop", "Emergency stop: the robot is held until rearm.", "estop");
  add_verb(line, "rearm", "Lets the controller drive again.", "rearm");
  add_verb(line, "pause", "Freezes time.", "pause");
  add_verb(line, "resume", "Lets time go on.", "resume");
  add_verb(line, "reset", "Ends the run and starts a new one (real time).", "reset");
  CommandLine step = add_verb(line, "step", "Takes some steps while paused.", "step 10");
  step.option("count", words.count, "steps (default 1)");
  step.options_between_words();
}

/// What the words say without a look at the lab: a mistake in them is answered at once. Nothing for a goal of some joints.
std::optional<Action> action_of(const std::string& verb, const Words& words) {
  if (verb == "set") return set(words.target, words.assignment);
  if (verb == "push") return push(words.target, words.list, words.seconds);
  if (verb == "payload") return payload(words.target, words.mass, words.com);
  if (verb == "step") return steps(words.count);
  if (verb != "goal") return plain(verb);
  if (!words.place.frame.empty()) return goal(words.place, words.duration);
  if (words.list.empty())
    throw UsageError("goal: needs a number for every joint, JOINT=VALUE, or --frame and --position");
  if (names_joints(words.list)) return std::nullopt;
  return goal(words.list, words.duration);
}

int send_goal(Guest& guest, const Options& options, const Words& words, std::optional<Action> action) {
  run_t known{};
  std::vector<double> current;
  if ((!action || words.wait) && !read_run_and_reference(guest, known, current)) return no_answer(options);
  if (!action) action = goal(words.list, words.duration, known.joint_names, current, followers_of(known));
  return words.wait ? request_and_wait(guest, options, *action, known) : request(guest, options, *action);
}

int send_verb(const std::string& verb, const Options& options, const Words& words) {
  const std::optional<Action> action = action_of(verb, words);
  Guest guest(options);
  // an emergency stop does not wait to know which lab: without --run it stops every lab that hears it
  if (verb != "estop" && !guest.bind_to_run()) return no_answer(options);
  if (verb == "goal" || !action) return send_goal(guest, options, words, action);
  if (verb == "get") return get(guest, options, words);
  return request(guest, options, *action);
}

int run(int argc, char** argv) {
  CommandLine line("lab-send", "Sends one request to the simulator of a running lab and prints the answer.");
  line.needs_verb();
  line.footer(
      "Exit codes: 0 done, 1 goal not reached (--wait), 2 usage, 7 refused or not confirmed.\nexample: "
      "lab-send goal 0.1 -0.4 0.8 0 0.2 0 "
      "--duration 2");
  Options options;
  Words words;
  const Option timeout = add_options(line, options);
  add_verbs(line, words);
  if (const auto code = line.parse(argc, argv)) return *code;
  if (timeout.given()) options.wait_seconds = options.timeout;
  struct sigaction action{};
  action.sa_handler = [](int number) { interrupted = number; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  options.follow = words.wait;
  return guarded_main("lab-send", [&] {
    try {
      return send_verb(line.chosen(), options, words);
    } catch (const UsageError& error) {
      return refuse("lab-send", error.what(), kUsage);
    }
  });
}

}  // namespace
}  // namespace lab::send

int main(int argc, char** argv) {
  return lab::run_program("lab-send", [&] { return lab::send::run(argc, argv); });
}
