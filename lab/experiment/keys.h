// The table of all keys of an experiment: reader, writers, near names and docs/experiments.md come from it. A new key is
// a member of Experiment and one row here; the controller's gains are in gains.h.
#pragma once
#include <concepts>
#include <string>
#include <type_traits>

#include "lab/experiment/experiment.h"
#include "lab/experiment/gains.h"
#include "lab/experiment/key.h"

namespace lab {

inline constexpr const char* kMustBeGiven = "must be given";

/// The same for what stands in one item of a list.
template <class P, class F>
  requires std::same_as<std::remove_const_t<P>, PlannedPush>
void for_each_part(P& push, F&& f) {
  f(Key{"time", "s", kMustBeGiven, "when it begins", 0, 1e7}, push.time);
  f(Key{"duration", "s", kMustBeGiven, "how long it lasts", 1e-6, 1e7}, push.duration);
  f(Key{"frame", "", kMustBeGiven, "of the robot"}, push.frame);
  f(Key{"force", "N", kMustBeGiven, "world axes"}, push.force);
  f(Key{"torque", "Nm", "[0, 0, 0]", "world axes"}, push.torque);
}
template <class P, class F>
  requires std::same_as<std::remove_const_t<P>, PlannedPayload>
void for_each_part(P& payload, F&& f) {
  f(Key{"time", "s", kMustBeGiven, "from when on", 0, 1e7}, payload.time);
  f(Key{"frame", "", kMustBeGiven, "of the robot"}, payload.frame);
  f(Key{"mass", "kg", kMustBeGiven, "0 takes it off", 0, 1e6}, payload.mass);
  f(Key{"com", "m", "[0, 0, 0]", "in the frame", -1e3, 1e3}, payload.com);
}
template <class T>
concept HasParts = requires(T& item) { for_each_part(item, [](const Key&, auto&) {}); };

/// Calls f(key, member) for every key in the order of the file.
template <class E, class F>
void for_each_key(E& e, F&& f) {
  using K = Key;
  constexpr double kTiny = 1e-6, kLong = 1e7;
  f(K{"name", "", "the file's name", "name of the run"}, e.name);
  f(K{"seed", "", "0", "seed of everything random"}, e.seed);
  f(K{"ready", "s", "10", "wall time for all processes to become READY", kTiny, kLong, {}, false}, e.ready);
  f(K{"deadline", "s", "10", "wall time without progress that ends the run", kTiny, kLong, {}, false},
    e.deadline);

  f(K{"robot.model", "", "must be given",
      "`builtin:manipulator`, `builtin:humanoid`, `package://NAME/..`, or a file, looked for beside the "
      "experiment and in "
      "the folders above it"},
    e.robot.model);
  f(K{"robot.armature", "kg m2, kg", "0", "rotor inertia per joint; the controller knows it too", 0},
    e.robot.armature);
  f(K{"robot.mimic", "", "true", "`false` frees the joints that mimic others"}, e.robot.mimic);
  f(K{"robot.floating_base", "", "false", "`true` lets the root link float"}, e.robot.floating_base);
  f(K{"robot.lock", "rad, m", "nothing", "joint: where it is welded; it then has no entry in any vector"},
    e.robot.lock);

  f(K{"simulator.dt", "s", "0.001", "time step", kTiny, 1}, e.simulator.dt);
  f(K{"simulator.duration", "s", "1", "simulated time; the last step is the nearest to it", kTiny, kLong},
    e.simulator.duration);
  f(K{"simulator.clock",
      "",
      "lockstep",
      "`lockstep`: as fast as it goes, same bytes every time; `realtime`: by the wall clock, with a watchdog",
      -kInf,
      kInf,
      {"lockstep", "realtime"}},
    e.simulator.clock);
  f(K{"simulator.integrator",
      "",
      "semi_implicit_euler",
      "`semi_implicit_euler` (v first, then q with the new v) or `rk4` (effort held over the step)",
      -kInf,
      kInf,
      {"semi_implicit_euler", "rk4"}},
    e.simulator.integrator);
  f(K{"simulator.q0", "rad, m", "neutral", "configuration at step 0"}, e.simulator.q0);
  f(K{"simulator.v0", "rad/s, m/s", "0", "velocity at step 0"}, e.simulator.v0);
  f(K{"simulator.damping", "Nm s/rad, N s/m", "0", "viscous friction of the joints", 0}, e.simulator.damping);
  f(K{"simulator.friction", "Nm, N", "0", "dry friction of the joints, smoothed: friction * tanh(v / 0.01)",
      0},
    e.simulator.friction);
  f(K{"simulator.gravity", "m/s2", "[0, 0, -9.81]", "in the world; the controller knows it too"},
    e.simulator.gravity);
  f(K{"simulator.allow_fall", "", "false", "`true` lets a floating robot fall: there is no ground yet"},
    e.simulator.allow_fall);
  f(K{"simulator.noise.q", "rad, m", "0",
      "standard deviation of the Gaussian noise on q in ROBOT_STATE, per joint", 0, 1e3},
    e.simulator.noise.q);
  f(K{"simulator.noise.v", "rad/s, m/s", "0", "the same on v", 0, 1e3}, e.simulator.noise.v);
  f(K{"simulator.delay", "s", "0", "age of q and v in ROBOT_STATE, rounded to whole steps", 0, 1},
    e.simulator.delay);
  f(K{"simulator.pushes", "s, N, Nm", "none",
      "list of `{time, duration, frame, force, torque}`: a wrench on a frame, world axes, at the frame's "
      "origin; torque may be left out"},
    e.simulator.pushes);
  f(K{"simulator.payloads", "s, kg, m", "none",
      "list of `{time, frame, mass, com}`: from then on a point mass is fixed to the frame, in place of what "
      "it carried; the controller does not know; "
      "com (in the frame) may be left out"},
    e.simulator.payloads);
  f(K{"simulator.limit_repulsion.stiffness", "Nm/rad, N/m", "0",
      "spring that pushes a joint back before its position limits", 0},
    e.simulator.limit_repulsion.stiffness);
  f(K{"simulator.limit_repulsion.damping", "Nm s/rad, N s/m", "0",
      "its damper, as it is at the limit; it sets in with the spring", 0},
    e.simulator.limit_repulsion.damping);
  f(K{"simulator.limit_repulsion.margin", "rad, m", "0.1", "how far before the limit both begin", 0},
    e.simulator.limit_repulsion.margin);

  f(K{"planner.kind", "", "hold",
      "`hold` (stay at q0), `cubic`, `quintic`, `sinusoid`, `point_to_point`, `waypoints`, `line` or "
      "`circle`"},
    e.planner.kind);
  f(K{"planner.goal", "rad, m", "needed by cubic, quintic", "where the motion ends, inside the joint limits"},
    e.planner.goal);
  f(K{"planner.duration", "s", "the simulator's",
      "time from q0 to the goal, or along a line or circle; then it stays there. 0: the shortest within "
      "`speed` and `acceleration`",
      0, kLong},
    e.planner.duration);
  f(K{"planner.offset", "rad, m", "simulator.q0",
      "sinusoid: q = offset + amplitude sin(frequency t + phase)"},
    e.planner.offset);
  f(K{"planner.amplitude", "rad, m", "0", "sinusoid"}, e.planner.amplitude);
  f(K{"planner.frequency", "rad/s", "1 + 0.3 i", "sinusoid; i = 0 for the first joint", 0},
    e.planner.frequency);
  f(K{"planner.phase", "rad", "0", "sinusoid"}, e.planner.phase);
  f(K{"planner.targets", "rad, m", "needed by point_to_point, waypoints",
      "a list of configurations that are visited in turn, the first from q0: along quintics with a rest at "
      "each, or (waypoints) along one spline"},
    e.planner.targets);
  f(K{"planner.times", "s", "the shortest", "waypoints: when each target is reached, rising", kTiny, kLong},
    e.planner.times);
  f(K{"planner.dwell", "s", "0.5", "point_to_point: rest at each target", 0, kLong}, e.planner.dwell);
  f(K{"planner.cycle", "", "true",
      "point_to_point: from the last target to the first again; `false`: stay there"},
    e.planner.cycle);
  f(K{"planner.speed", "", "0.5",
      "share of the joints' speed limits that is used where the planner chooses the time: point_to_point, "
      "waypoints, `duration: 0`, goals given while it runs",
      0.01, 1},
    e.planner.speed);
  f(K{"planner.acceleration", "rad/s2, m/s2", "no bound",
      "largest acceleration where the planner chooses the time", kTiny},
    e.planner.acceleration);
  f(K{"planner.frame", "", "needed by line, circle", "the frame that moves along the path"}, e.planner.frame);
  f(K{"planner.to", "m", "needed by line", "where the line ends, in the world"}, e.planner.to);
  f(K{"planner.center", "m", "needed by circle",
      "a point of the axis about which the frame turns, from where it is at q0"},
    e.planner.center);
  f(K{"planner.normal", "", "[0, 0, 1]", "circle: the direction of its axis; turns are by the right hand"},
    e.planner.normal);
  f(K{"planner.turns", "", "1", "circle: how often round; negative: the other way", -100, 100},
    e.planner.turns);
  f(K{"planner.keep_orientation", "", "false",
      "line, circle: `true` keeps the frame's orientation as it is at q0"},
    e.planner.keep_orientation);
  f(K{"planner.lead", "steps", "4",
      "how far references run ahead; from 16 on the planner works in batches and the loop runs about twice "
      "as fast",
      0, 128},
    e.planner.lead);

  f(K{"controller.kind", "", "pd",
      "`none`, `pd`, `pd_gravity`, `computed_torque`, `cartesian_impedance` or `com_velocity`; formulas "
      "below"},
    e.controller.kind);
  for_each_joint_gain(f, e.controller);
  f(K{"controller.frame", "", "needed by cartesian_impedance", "the frame that is held, such as the tool"},
    e.controller.frame);
  for_each_task_gain(f, e.controller);
  f(K{"controller.every", "steps", "1", "steps from one command to the next; it is held between", 1, 128},
    e.controller.every);
  f(K{"controller.limit_effort", "", "false",
      "`true`: the controller itself cuts its command at the joints' effort limits; an event "
      "`effort_limited` says so when it begins"},
    e.controller.limit_effort);
  f(K{"controller.model.mass_scale", "", "1", "model error: the controller believes in every mass times this",
      kTiny, 1e6},
    e.controller.model.mass_scale);
  f(K{"controller.model.com_shift", "m", "nothing",
      "model error: link (or joint, for all that moves with it in one piece): [x, y, z] by which its centre "
      "of mass is "
      "thought to be off, in its own axes"},
    e.controller.model.com_shift);
  f(K{"controller.model.without", "", "nothing",
      "model error: links or joints whose masses the controller does not know, such as a tool"},
    e.controller.model.without);

  f(K{"logger.every", "steps", "1", "steps from one logged step to the next", 1, 1e9, {}, false},
    e.logger.every);

  f(K{"renderer.enabled", "", "true", "`false`: no pictures", -kInf, kInf, {}, false}, e.renderer.enabled);
  f(K{"renderer.fps", "1/s", "20", "pictures per second of simulated time", 1e-3, 1e4, {}, false},
    e.renderer.fps);
  f(K{"renderer.size", "pixels", "[640, 480]", "width and height", 16, 4096, {}, false}, e.renderer.size);
  f(K{"renderer.camera",
      "",
      "iso",
      "`iso`, `front`, `side` or `top`",
      -kInf,
      kInf,
      {"iso", "front", "side", "top"},
      false},
    e.renderer.camera);
  f(K{"renderer.orthographic", "", "false", "`true`: without perspective", -kInf, kInf, {}, false},
    e.renderer.orthographic);
  f(K{"renderer.orbit",
      "rad/s",
      "0",
      "the camera goes round the robot at this speed, seen from above",
      -100,
      100,
      {},
      false},
    e.renderer.orbit);
  f(K{"renderer.follow",
      "",
      "nothing",
      "frame that the camera goes along with, without turning",
      -kInf,
      kInf,
      {},
      false},
    e.renderer.follow);
  f(K{"renderer.quality",
      "",
      "live",
      "`draft` (plain), `live` (anti-aliased) or `fine` (and a soft shadow)",
      -kInf,
      kInf,
      {"draft", "live", "fine"},
      false},
    e.renderer.quality);

  f(K{"renderer.ghost",
      "",
      "0",
      "`ghost.png` shows the way in this many poses; 0: no such picture",
      0,
      100,
      {},
      false},
    e.renderer.ghost);
  f(K{"renderer.trace",
      "",
      "nothing",
      "frame whose way is drawn, from blue to red as time goes by",
      -kInf,
      kInf,
      {},
      false},
    e.renderer.trace);
  f(K{"renderer.reference",
      "",
      "false",
      "`true`: the wanted pose is drawn as a green ghost",
      -kInf,
      kInf,
      {},
      false},
    e.renderer.reference);

  f(K{"safety.timeout", "s", "0.02",
      "real time: a command made from an older state is stale, and the robot is held", kTiny, 10},
    e.safety.timeout);
  f(K{"safety.hold",
      "",
      "gravity",
      "how the robot is held: braked and its weight borne (`gravity`), or only braked (`damping`)",
      -kInf,
      kInf,
      {"gravity", "damping"}},
    e.safety.hold);
  f(K{"safety.rearm",
      "",
      "auto",
      "`auto`: 20 fresh commands in a row end holding; `manual`: a person's `rearm` has to come first",
      -kInf,
      kInf,
      {"auto", "manual"}},
    e.safety.rearm);

  f(K{"faults.drop",
      "%",
      "0",
      "incoming packets that every process loses on purpose; the log stays the same",
      0,
      90,
      {},
      false},
    e.faults.drop);

  f(K{"processes",
      "",
      "the usual five",
      "name: command line that takes the place of the usual one, or joins; `{run_dir}` stands for the run's "
      "folder",
      -kInf,
      kInf,
      {},
      false},
    e.processes);
  f(K{"evaluation.band", "rad, m", "0.01", "error within which a joint counts as settled", 0, kLong},
    e.evaluation.band);
  f(K{"evaluation.frame", "", "the last link", "frame whose errors are the tool's"}, e.evaluation.frame);
  f(K{"expect", "", "nothing", "metric: {max: x}, {min: x} or both; a run outside ends with exit code 1"},
    e.expect);
}

}  // namespace lab
