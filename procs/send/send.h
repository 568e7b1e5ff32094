// Words of a command line as an action, and the simulator's answer in words.
#pragma once
#include <lab/reply_t.hpp>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "lab/signals/signals.h"

namespace lab::send {

/// One line about what is wrong with the command line.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// What the words mean: numbers for all joints in model order, or JOINT=VALUE for some.
bool names_joints(std::span<const std::string> words);

/// `goal`: a configuration; `duration` in s, 0 = as fast as planner.speed of the speed limits allows. With names, the
/// others keep their value in `current`; `followers` says which joint follows which (they take no goals). Throws UsageError.
Action goal(std::span<const std::string> words, double duration);
Action goal(std::span<const std::string> words, double duration, const std::vector<std::string>& joints,
            const std::vector<double>& current, const std::map<std::string, std::string>& followers = {});

/// A target pose of a frame in the world, as typed: "x,y,z" in m; "roll,pitch,yaw" in rad or "x,y,z,w", or neither when any
/// orientation will do.
struct Place {
  std::string frame, position, rpy, quaternion;
};
/// `goal --frame`. Throws UsageError.
Action goal(const Place& place, double duration);

/// `set PROC KEY=VALUE[,VALUE..]`; a word that is no number goes into text.
Action set(const std::string& process, const std::string& assignment);

/// `push FRAME FX FY FZ [NX NY NZ]` in N and Nm, for some seconds.
Action push(const std::string& frame, std::span<const std::string> words, double seconds);

/// `payload FRAME MASS [--com X,Y,Z]` in kg and m.
Action payload(const std::string& frame, const std::string& mass, const std::string& com);

/// `pause`, `resume`, `estop`, `rearm`, `reset`, `get`; `step` with a count.
Action plain(const std::string& verb);
Action steps(int64_t count);

/// One line of the answer to `get`.
struct Setting {
  std::string name, value, unit;
};
std::vector<Setting> settings_of(const std::string& answer);

/// "goal accepted from step 1234".
std::string told(const Action& action, const reply_t& reply);

}  // namespace lab::send
