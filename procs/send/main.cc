// lab-send: sends one request to the simulator and prints the answer.
#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <lab/reference_t.hpp>
#include <lab/request_t.hpp>
#include <lab/run_t.hpp>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/util/json_text.h"
#include "lab/run/run.h"
#include "lab/run/shell.h"
#include "procs/send/guest.h"
#include "procs/send/send.h"
#include "wire/process/participant.h"
#include "wire/protocol/convert.h"
#include "wire/schema/codec.h"

namespace lab::send {
namespace {

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

int request(Guest& guest, const Options& options, const Action& action) {
  request_t message{};
  message.run = guest.run();
  message.step = -1;
  message.utime = wall_now();
  message.sender = sender();
  message.id = 1;
  message.action = to_message(action);
  std::optional<reply_t> reply;
  guest.ask(Channel::Request, encode(message), [&](Channel channel, std::span<const uint8_t> bytes) {
    if (channel != Channel::Reply) return false;
    auto answer = decode<reply_t>(bytes);
    if (answer.sender != message.sender || answer.id != message.id) return false;
    reply = std::move(answer);
    return true;
  });
  if (interrupted) return 128 + interrupted;
  if (!reply) {
    if (options.as_json)
      fmt::print("{}\n", json_text(nlohmann::ordered_json{{"verb", action.verb}, {"confirmed", false}}));
    fmt::print(stderr, "lab-send: {} unconfirmed: no answer in {:g} s; see the log\n", action.verb,
               options.timeout);
    return kTransport;
  }
  if (options.as_json)
    fmt::print("{}\n", json_text(nlohmann::ordered_json{
                           {"verb", action.verb},
                           {"confirmed", true},
                           {"ok", reply->ok != 0},
                           {"reason", reply->reason},
                           {"step", reply->step},
                           {"run", fmt::format("{:016x}", static_cast<uint64_t>(reply->run))}}));
  else if (reply->ok)
    fmt::print("{}\n", told(action, *reply));
  if (!reply->ok) fmt::print(stderr, "lab-send: {}\n", told(action, *reply));
  return reply->ok ? kOk : kTransport;
}

int no_answer(const Options& options) {
  if (interrupted) return 128 + interrupted;
  fmt::print(stderr, "lab-send: no simulator answers in {:g} s; is a lab running here?\n", options.timeout);
  return kTransport;
}

/// The words of the command line.
struct Words {
  std::vector<std::string> list;  ///< of goal and push
  std::string target, assignment, mass, com;
  Place place;
  double duration = 0, seconds = 0.1;
  int64_t count = 1;
};

void add_options(CLI::App& app, Options& options) {
  app.add_option("-l,--url", options.url, "LCM URL (default: env LCM_DEFAULT_URL)");
  app.add_option("--prefix", options.prefix, "of channel names, where several robots share a bus")
      ->envname("LAB_PREFIX");
  app.add_option("--run-dir", options.run_dir, "the lab's folder: only its own simulator is asked")
      ->envname("LAB_RUN_DIR");
  app.add_option("--run", options.run, "only this run (hexadecimal), where several are on the bus")
      ->check([](const std::string& word) {
        return !word.empty() && word.size() <= 16 &&
                       word.find_first_not_of("0123456789abcdefABCDEF") == std::string::npos
                   ? ""
                   : "not a hexadecimal number";
      });
  app.add_option("--timeout", options.timeout, "s to wait for the answer")->check(CLI::PositiveNumber);
  app.add_flag("--json", options.as_json, "print JSON");
  app.fallthrough();
}

CLI::App* add_verb(CLI::App& app, const char* name, const char* what, const char* example) {
  CLI::App* sub = app.add_subcommand(name, what);
  sub->footer(std::string("example: lab-send ") + example);
  return sub;
}

void add_goal(CLI::App& app, Words& words) {
  CLI::App* goal = add_verb(
      app, "goal",
      "Moves the reference to a configuration, or a frame to a pose, from where it is, without a jump.",
      "goal --frame effector_body --position 0.5,0.1,0.6 --rpy 0,1.57,0 --duration 2");
  CLI::Option* q =
      goal->add_option("q", words.list, "a number for every joint (rad, m), or JOINT=VALUE for some")
          ->allow_extra_args();
  CLI::Option* frame =
      goal->add_option("--frame", words.place.frame, "of the robot, to move to a pose in the world")
          ->excludes(q);
  CLI::Option* position = goal->add_option("--position", words.place.position, "x,y,z in m")->needs(frame);
  CLI::Option* rpy =
      goal->add_option("--rpy", words.place.rpy, "roll,pitch,yaw in rad (default: any orientation)")
          ->needs(position);
  goal->add_option("--quaternion", words.place.quaternion, "x,y,z,w instead of --rpy")
      ->needs(position)
      ->excludes(rpy);
  goal->add_option("--duration", words.duration,
                   "s (default: as fast as planner.speed, half, of the speed limits allows)");
  goal->positionals_at_end(false);
}

void add_verbs(CLI::App& app, Words& words) {
  add_goal(app, words);
  CLI::App* set = add_verb(app, "set", "Changes a value of a process while it runs.", "set controller kp=80");
  set->add_option("process", words.target, "such as controller")->required();
  set->add_option("assignment", words.assignment, "KEY=VALUE, or KEY=VALUE,VALUE.. for each joint")
      ->required();
  CLI::App* push = add_verb(app, "push", "Pushes a frame with a force (N) and a torque (Nm) in world axes.",
                            "push effector_body 20 0 0 --for 0.2");
  push->add_option("frame", words.target, "of the robot")->required();
  push->add_option("wrench", words.list, "FX FY FZ [NX NY NZ]")->required()->allow_extra_args();
  push->add_option("--for", words.seconds, "s (default 0.1)");
  push->positionals_at_end(false);
  CLI::App* payload = add_verb(app, "payload",
                               "Fixes a mass to a frame of the simulated robot, in place of what it "
                               "carried; the controller does not know.",
                               "payload effector_body 2 --com 0,0,0.1");
  payload->add_option("frame", words.target, "of the robot")->required();
  payload->add_option("mass", words.mass, "kg; 0 takes it off")->required();
  payload->add_option("--com", words.com, "x,y,z in the frame, m (default: at its origin)");
  add_verb(app, "estop", "Emergency stop: the robot is held until rearm.", "estop");
  add_verb(app, "rearm", "Lets the controller drive again.", "rearm");
  add_verb(app, "pause", "Freezes time.", "pause");
  add_verb(app, "resume", "Lets time go on.", "resume");
  add_verb(app, "reset", "Ends the run and starts a new one (real time).", "reset");
  CLI::App* step = add_verb(app, "step", "Takes some steps while paused.", "step 10");
  step->add_option("count", words.count, "steps (default 1)");
  step->positionals_at_end(false);
}

int send_goal(Guest& guest, const Options& options, const Words& words) {
  if (!words.place.frame.empty()) return request(guest, options, goal(words.place, words.duration));
  if (words.list.empty())
    throw UsageError("goal: needs a number for every joint, JOINT=VALUE, or --frame and --position");
  if (!names_joints(words.list)) return request(guest, options, goal(words.list, words.duration));
  run_t known{};
  std::vector<double> current;
  if (!read_run_and_reference(guest, known, current)) return no_answer(options);
  return request(guest, options,
                 goal(words.list, words.duration, known.joint_names, current, followers_of(known)));
}

int send_verb(const std::string& verb, const Options& options, const Words& words) {
  Guest guest(options);
  // an emergency stop does not wait to know which lab: without --run it stops every lab that hears it
  if (verb != "estop" && !guest.bind_to_run()) return no_answer(options);
  if (verb == "goal") return send_goal(guest, options, words);
  if (verb == "set") return request(guest, options, set(words.target, words.assignment));
  if (verb == "push") return request(guest, options, push(words.target, words.list, words.seconds));
  if (verb == "payload") return request(guest, options, payload(words.target, words.mass, words.com));
  if (verb == "step") return request(guest, options, steps(words.count));
  return request(guest, options, plain(verb));
}

int run(int argc, char** argv) {
  CLI::App app{"Sends one request to the simulator of a running lab and prints the answer.", "lab-send"};
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 2 usage, 7 refused or not confirmed.\nexample: lab-send goal 0.1 -0.4 0.8 0 0.2 0 "
      "--duration 2");
  Options options;
  Words words;
  add_options(app, options);
  add_verbs(app, words);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kOk : kUsage;
  }
  struct sigaction action{};
  action.sa_handler = [](int number) { interrupted = number; };
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);

  return guarded_main("lab-send", [&] {
    try {
      return send_verb(app.get_subcommands().front()->get_name(), options, words);
    } catch (const UsageError& error) {
      fmt::print(stderr, "lab-send: {}\n", error.what());
      return int{kUsage};
    }
  });
}

}  // namespace
}  // namespace lab::send

int main(int argc, char** argv) { return lab::send::run(argc, argv); }
