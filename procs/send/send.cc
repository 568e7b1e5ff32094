#include "procs/send/send.h"

#include <fmt/format.h>
#include <rbd/spatial/so3.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "core/util/number.h"
#include "lab/experiment/experiment.h"

namespace lab::send {
namespace {

bool is_number(const std::string& word, double& value) {
  char* end = nullptr;
  value = std::strtod(word.c_str(), &end);
  return !word.empty() && *end == '\0';
}

double number_of(const std::string& word, const std::string& what) {
  double value = 0;
  if (!is_number(word, value)) throw UsageError(fmt::format("{}: '{}' is not a number", what, word));
  if (!std::isfinite(value)) throw UsageError(fmt::format("{}: {} is not finite", what, word));
  return value;
}

/// "1,2,3"
std::vector<double> numbers(const std::string& list, size_t wanted, const std::string& what) {
  std::vector<double> out;
  for (size_t at = 0; at <= list.size();) {
    const size_t comma = std::min(list.find(',', at), list.size());
    out.push_back(number_of(list.substr(at, comma - at), what));
    at = comma + 1;
  }
  if (out.size() != wanted)
    throw UsageError(fmt::format("{}: '{}' has {} numbers, expected {}", what, list, out.size(), wanted));
  return out;
}

Action with_duration(double duration) {
  Action action{"goal", "", "", "", {}};
  if (duration < 0 || !std::isfinite(duration))
    throw UsageError(fmt::format("--duration: {} is no time in s", duration));
  if (duration > 0) {
    action.key = "duration";
    action.text = number(duration);
  }
  return action;
}

}  // namespace

bool names_joints(std::span<const std::string> words) {
  return std::any_of(words.begin(), words.end(),
                     [](const std::string& word) { return word.find('=') != std::string::npos; });
}

Action goal(std::span<const std::string> words, double duration) {
  Action action = with_duration(duration);
  for (const std::string& word : words) action.values.push_back(number_of(word, "goal"));
  return action;
}

Action goal(std::span<const std::string> words, double duration, const std::vector<std::string>& joints,
            const std::vector<double>& current, const std::map<std::string, std::string>& followers) {
  Action action = with_duration(duration);
  if (joints.size() != current.size())
    throw UsageError("goal: this robot's configuration has other parts than joints; give all of its numbers");
  action.values = current;
  for (const std::string& word : words) {
    const size_t equals = word.find('=');
    if (equals == std::string::npos)
      throw UsageError(fmt::format("goal: '{}': either all numbers or JOINT=VALUE", word));
    const std::string joint = word.substr(0, equals);
    if (const auto follows = followers.find(joint); follows != followers.end())
      throw UsageError(
          fmt::format("goal: '{}' follows '{}'; give a goal for that one", joint, follows->second));
    const auto place = std::find(joints.begin(), joints.end(), joint);
    if (place == joints.end())
      throw UsageError(
          fmt::format("goal: the robot has no joint '{}'{}", joint, did_you_mean(joint, joints)));
    action.values[static_cast<size_t>(place - joints.begin())] =
        number_of(word.substr(equals + 1), "goal: " + joint);
  }
  return action;
}

Action goal(const Place& place, double duration) {
  Action action = with_duration(duration);
  action.target = place.frame;
  if (place.position.empty())
    throw UsageError(fmt::format("goal: --frame {} needs --position x,y,z", place.frame));
  action.values = numbers(place.position, 3, "--position");
  Eigen::Quaterniond turn;
  if (!place.quaternion.empty()) {
    const std::vector<double> x = numbers(place.quaternion, 4, "--quaternion");
    turn.coeffs() << x[0], x[1], x[2], x[3];
    if (!(std::abs(turn.norm() - 1) < 0.01))
      throw UsageError(fmt::format("--quaternion: its length is {}, must be 1", number(turn.norm())));
    turn.normalize();
  } else if (!place.rpy.empty()) {
    const std::vector<double> x = numbers(place.rpy, 3, "--rpy");
    turn = rbd::rpyToMatrix(x[0], x[1], x[2]);
  } else {
    return action;
  }
  action.values.insert(action.values.end(), turn.coeffs().begin(), turn.coeffs().end());
  return action;
}

Action set(const std::string& process, const std::string& assignment) {
  const size_t equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw UsageError(fmt::format("set: '{}' must look like kp=80", assignment));
  Action action{"set", process, assignment.substr(0, equals), "", {}};
  std::string rest = assignment.substr(equals + 1);
  double value = 0;
  if (!is_number(rest.substr(0, rest.find(',')), value)) {
    if (rest.empty()) throw UsageError(fmt::format("set: '{}' has no value", assignment));
    action.text = rest;
    return action;
  }
  for (size_t comma = 0; comma != std::string::npos;
       rest = comma == std::string::npos ? "" : rest.substr(comma + 1)) {
    comma = rest.find(',');
    action.values.push_back(number_of(rest.substr(0, comma), "set: " + action.key));
  }
  return action;
}

Action push(const std::string& frame, std::span<const std::string> words, double seconds) {
  if (words.size() != 3 && words.size() != 6)
    throw UsageError(
        fmt::format("push: has {} numbers, expected 3 (force, N) or 6 (force and torque, Nm)", words.size()));
  if (!(seconds > 0) || !std::isfinite(seconds))
    throw UsageError(fmt::format("--for: {} is no time in s", seconds));
  std::vector<double> x;
  for (const std::string& word : words) x.push_back(number_of(word, "push"));
  x.resize(6, 0);
  return {"push", frame, "", "", {x[3], x[4], x[5], x[0], x[1], x[2], seconds}};
}

Action payload(const std::string& frame, const std::string& mass, const std::string& com) {
  Action action{"payload", frame, "", "", {number_of(mass, "payload")}};
  const std::vector<double> place = com.empty() ? std::vector<double>(3, 0) : numbers(com, 3, "--com");
  action.values.insert(action.values.end(), place.begin(), place.end());
  return action;
}

Action plain(const std::string& verb) { return {verb, "", "", "", {}}; }

Action steps(int64_t count) {
  if (count < 1) throw UsageError(fmt::format("step: {} is not a count", count));
  return {"step", "", "", "", {static_cast<double>(count)}};
}

std::vector<Setting> settings_of(const std::string& answer) {
  std::vector<Setting> all;
  std::stringstream lines(answer);
  for (std::string line; std::getline(lines, line);) {
    Setting setting;
    std::stringstream parts(line);
    std::getline(std::getline(std::getline(parts, setting.name, '\t'), setting.value, '\t'), setting.unit);
    all.push_back(std::move(setting));
  }
  return all;
}

std::string told(const Action& action, const reply_t& reply) {
  if (!reply.ok) return fmt::format("{} refused: {}", action.verb, reply.reason);
  if (action.verb == "pause") return fmt::format("paused before step {}", reply.step);
  if (action.verb == "resume") return fmt::format("goes on with step {}", reply.step);
  if (action.verb == "reset")
    return fmt::format("run {:016x} ends with step {}, a new one starts", static_cast<uint64_t>(reply.run),
                       reply.step);
  if (action.verb == "step") return fmt::format("{} steps from step {}", action.values[0], reply.step);
  return fmt::format("{} accepted, from step {}", action.verb, reply.step);
}

}  // namespace lab::send
