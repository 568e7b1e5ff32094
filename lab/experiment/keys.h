// The table of all keys of an experiment: reader, writers, suggestions and docs/experiments.md use it. A new key is
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

/// Calls f(key, member) for every key of one item of a list.
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

inline constexpr double kTiny = 1e-6, kLong = 1e7;

// The sections of for_each_key.

template <class E, class F>
void run_keys(E& e, F& f) {
  f(Key{"name", "", "the file's name", "name of the run"}, e.name);
  f(Key{"seed", "", "0", "seed of everything random"}, e.seed);
  f(Key{"ready", "s", "10", "wall time for all processes to become READY", kTiny, kLong}.outside_run(),
    e.ready);
  f(Key{"deadline", "s", "10", "wall time without progress that ends the run", kTiny, kLong}.outside_run(),
    e.deadline);
}

template <class E, class F>
void robot_keys(E& e, F& f) {
  f(Key{"robot.model", "", "must be given",
        "`builtin:manipulator`, `builtin:humanoid`, `package://NAME/..`, or a file, looked for beside the "
        "experiment and in the folders above it"},
    e.robot.model);
  f(Key{"robot.armature", "kg m2, kg", "0", "rotor inertia per joint; the controller knows it too", 0},
    e.robot.armature);
  f(Key{"robot.mimic", "", "true", "`false` frees the joints that mimic others"}, e.robot.mimic);
  f(Key{"robot.floating_base", "", "false", "`true` lets the root link float"}, e.robot.floating_base);
  f(Key{"robot.lock", "rad, m", "nothing", "joint: where it is welded; it then has no entry in any vector"},
    e.robot.lock);
}

template <class E, class F>
void simulator_keys(E& e, F& f) {
  f(Key{"simulator.dt", "s", "0.001", "time step", kTiny, 1}, e.simulator.dt);
  f(Key{"simulator.duration", "s", "1", "simulated time; the last step is the nearest to it", kTiny, kLong},
    e.simulator.duration);
  f(Key{"simulator.clock", "", "lockstep",
        "`lockstep`: as fast as it goes, same bytes every time; `realtime`: by the wall clock, with a "
        "watchdog"}
        .one_of({"lockstep", "realtime"}),
    e.simulator.clock);
  f(Key{"simulator.integrator", "", "semi_implicit_euler",
        "`semi_implicit_euler` (v first, then q with the new v) or `rk4` (effort held over the step)"}
        .one_of({"semi_implicit_euler", "rk4"}),
    e.simulator.integrator);
  f(Key{"simulator.q0", "rad, m", "neutral", "configuration at step 0"}, e.simulator.q0);
  f(Key{"simulator.v0", "rad/s, m/s", "0", "velocity at step 0"}, e.simulator.v0);
  f(Key{"simulator.damping", "Nm s/rad, N s/m", "0", "viscous friction of the joints", 0},
    e.simulator.damping);
  f(Key{"simulator.friction", "Nm, N", "0", "dry friction of the joints, smoothed: friction * tanh(v / 0.01)",
        0},
    e.simulator.friction);
  f(Key{"simulator.gravity", "m/s2", "[0, 0, -9.81]", "in the world; the controller knows it too"},
    e.simulator.gravity);
  f(Key{"simulator.allow_fall", "", "false", "`true` lets a floating robot fall: there is no ground yet"},
    e.simulator.allow_fall);
  f(Key{"simulator.noise.q", "rad, m", "0",
        "standard deviation of the Gaussian noise on q in ROBOT_STATE, per joint", 0, 1e3},
    e.simulator.noise.q);
  f(Key{"simulator.noise.v", "rad/s, m/s", "0", "the same on v", 0, 1e3}, e.simulator.noise.v);
  f(Key{"simulator.delay", "s", "0", "age of q and v in ROBOT_STATE, rounded to whole steps", 0, 1},
    e.simulator.delay);
}

template <class E, class F>
void disturbance_keys(E& e, F& f) {
  f(Key{"simulator.pushes", "s, N, Nm", "none",
        "list of `{time, duration, frame, force, torque}`: a wrench on a frame, world axes, at the frame's "
        "origin; torque may be left out"},
    e.simulator.pushes);
  f(Key{"simulator.payloads", "s, kg, m", "none",
        "list of `{time, frame, mass, com}`: from then on a point mass is fixed to the frame, in place of "
        "what it carried; the controller does not know; com (in the frame) may be left out"},
    e.simulator.payloads);
  f(Key{"simulator.limit_repulsion.stiffness", "Nm/rad, N/m", "0",
        "spring that pushes a joint back before its position limits", 0},
    e.simulator.limit_repulsion.stiffness);
  f(Key{"simulator.limit_repulsion.damping", "Nm s/rad, N s/m", "0",
        "its damper, as it is at the limit; it sets in with the spring", 0},
    e.simulator.limit_repulsion.damping);
  f(Key{"simulator.limit_repulsion.margin", "rad, m", "0.1", "how far before the limit both begin", 0},
    e.simulator.limit_repulsion.margin);
}

template <class E, class F>
void motion_keys(E& e, F& f) {
  f(Key{"planner.kind", "", "hold",
        "the motion: `hold` or another one of the motions in docs/experiments.md"},
    e.planner.kind);
  f(Key{"planner.goal", "rad, m", "needed by cubic, quintic",
        "where the motion ends, inside the joint limits"},
    e.planner.goal);
  f(Key{"planner.duration", "s", "the simulator's",
        "time from q0 to the goal, or along a line or circle; then it stays there. 0: the shortest within "
        "`speed` and `acceleration`",
        0, kLong},
    e.planner.duration);
  f(Key{"planner.offset", "rad, m", "simulator.q0",
        "sinusoid: q = offset + amplitude sin(frequency t + phase)"},
    e.planner.offset);
  f(Key{"planner.amplitude", "rad, m", "0", "sinusoid"}, e.planner.amplitude);
  f(Key{"planner.frequency", "rad/s", "1 + 0.3 i", "sinusoid; i = 0 for the first joint", 0},
    e.planner.frequency);
  f(Key{"planner.phase", "rad", "0", "sinusoid"}, e.planner.phase);
  f(Key{"planner.targets", "rad, m", "needed by point_to_point, waypoints",
        "a list of configurations that are visited in turn, the first from q0: along quintics with a rest at "
        "each, or (waypoints) along one spline"},
    e.planner.targets);
  f(Key{"planner.times", "s", "the shortest", "waypoints: when each target is reached, rising", kTiny, kLong},
    e.planner.times);
  f(Key{"planner.dwell", "s", "0.5", "point_to_point: rest at each target", 0, kLong}, e.planner.dwell);
  f(Key{"planner.cycle", "", "true",
        "point_to_point: from the last target to the first again; `false`: stay there"},
    e.planner.cycle);
  f(Key{"planner.speed", "", "0.5",
        "share of the joints' speed limits that is used where the planner chooses the time: point_to_point, "
        "waypoints, `duration: 0`, goals given while it runs",
        0.01, 1},
    e.planner.speed);
  f(Key{"planner.acceleration", "rad/s2, m/s2", "no bound",
        "largest acceleration where the planner chooses the time", kTiny},
    e.planner.acceleration);
}

template <class E, class F>
void path_keys(E& e, F& f) {
  f(Key{"planner.frame", "", "needed by line, circle", "the frame that moves along the path"},
    e.planner.frame);
  f(Key{"planner.to", "m", "needed by line", "where the line ends, in the world"}, e.planner.to);
  f(Key{"planner.center", "m", "needed by circle",
        "a point of the axis about which the frame turns, from where it is at q0"},
    e.planner.center);
  f(Key{"planner.normal", "", "[0, 0, 1]", "circle: the direction of its axis; turns are by the right hand"},
    e.planner.normal);
  f(Key{"planner.turns", "", "1", "circle: how often round; negative: the other way", -100, 100},
    e.planner.turns);
  f(Key{"planner.keep_orientation", "", "false",
        "line, circle: `true` keeps the frame's orientation as it is at q0"},
    e.planner.keep_orientation);
  f(Key{"planner.lead", "steps", "4",
        "how far references run ahead; from 16 on the planner works in batches and the loop runs about twice "
        "as fast",
        0, 128},
    e.planner.lead);
}

template <class E, class F>
void controller_keys(E& e, F& f) {
  f(Key{"controller.kind", "", "pd",
        "the control law: `pd` or another one of the controllers in docs/experiments.md"},
    e.controller.kind);
  for_each_joint_gain(f, e.controller);
  f(Key{"controller.frame", "", "needed by cartesian_impedance", "the frame that is held, such as the tool"},
    e.controller.frame);
  for_each_task_gain(f, e.controller);
  f(Key{"controller.every", "steps", "1", "steps from one command to the next; it is held between", 1, 128},
    e.controller.every);
  f(Key{"controller.limit_effort", "", "false",
        "`true`: the controller itself cuts its command at the joints' effort limits; an event "
        "`effort_limited` says so when it begins"},
    e.controller.limit_effort);
  f(Key{"controller.model.mass_scale", "", "1",
        "model error: the controller's model has every mass times this", kTiny, 1e6},
    e.controller.model.mass_scale);
  f(Key{"controller.model.com_shift", "m", "nothing",
        "model error: link (or joint, for all that moves with it in one piece): [x, y, z] by which its "
        "centre of mass is moved in the controller's model, in its own axes"},
    e.controller.model.com_shift);
  f(Key{"controller.model.without", "", "nothing",
        "model error: links or joints whose masses the controller does not know, such as a tool"},
    e.controller.model.without);
}

template <class E, class F>
void view_keys(E& e, F& f) {
  f(Key{"logger.every", "steps", "1", "steps from one logged step to the next", 1, 1e9}.outside_run(),
    e.logger.every);

  f(Key{"renderer.enabled", "", "true", "`false`: no pictures"}.outside_run(), e.renderer.enabled);
  f(Key{"renderer.fps", "1/s", "20", "pictures per second of simulated time", 1e-3, 1e4}.outside_run(),
    e.renderer.fps);
  f(Key{"renderer.size", "pixels", "[640, 480]", "width and height", 16, 4096}.outside_run(),
    e.renderer.size);
  f(Key{"renderer.camera", "", "iso", "`iso`, `front`, `side` or `top`"}
        .one_of({"iso", "front", "side", "top"})
        .outside_run(),
    e.renderer.camera);
  f(Key{"renderer.orthographic", "", "false", "`true`: without perspective"}.outside_run(),
    e.renderer.orthographic);
  f(Key{"renderer.orbit", "rad/s", "0",
        "the camera orbits the robot at this speed, counter-clockwise seen from above", -100, 100}
        .outside_run(),
    e.renderer.orbit);
  f(Key{"renderer.follow", "", "nothing", "frame that the camera goes along with, without turning"}
        .outside_run(),
    e.renderer.follow);
  f(Key{"renderer.quality", "", "live",
        "`draft` (plain), `live` (anti-aliased) or `fine` (and a soft shadow)"}
        .one_of({"draft", "live", "fine"})
        .outside_run(),
    e.renderer.quality);

  f(Key{"renderer.ghost", "", "0", "`ghost.png` shows the motion in this many poses; 0: no such picture", 0,
        100}
        .outside_run(),
    e.renderer.ghost);
  f(Key{"renderer.trace", "", "nothing", "frame whose way is drawn, from blue to red as time goes by"}
        .outside_run(),
    e.renderer.trace);
  f(Key{"renderer.reference", "", "false", "`true`: the wanted pose is drawn as a green ghost"}.outside_run(),
    e.renderer.reference);
}

template <class E, class F>
void other_keys(E& e, F& f) {
  f(Key{"safety.timeout", "s", "0.02",
        "real time: a command made from an older state is stale, and the robot is held", kTiny, 10},
    e.safety.timeout);
  f(Key{"safety.hold", "", "gravity",
        "how the robot is held: damped, with gravity compensation (`gravity`), or only damped (`damping`)"}
        .one_of({"gravity", "damping"}),
    e.safety.hold);
  f(Key{"safety.rearm", "", "auto",
        "`auto`: 20 fresh commands in a row end holding; `manual`: a person's `rearm` has to come first"}
        .one_of({"auto", "manual"}),
    e.safety.rearm);

  f(Key{"faults.drop", "%", "0",
        "incoming packets that every process loses on purpose; the log stays the same", 0, 90}
        .outside_run(),
    e.faults.drop);

  f(Key{"processes", "", "the usual five",
        "name: command line that takes the place of the usual one, or joins; `{run_dir}` stands for the "
        "run's folder"}
        .outside_run(),
    e.processes);
  f(Key{"evaluation.band", "rad, m", "0.01", "error within which a joint counts as settled", 0, kLong},
    e.evaluation.band);
  f(Key{"evaluation.frame", "", "the last link", "frame whose errors are the tool's"}, e.evaluation.frame);
  f(Key{"expect", "", "nothing", "metric: {max: x}, {min: x} or both; a run outside ends with exit code 1"},
    e.expect);
}

/// Calls f(key, member) for every key in the order of the file.
template <class E, class F>
void for_each_key(E& e, F&& f) {
  run_keys(e, f);
  robot_keys(e, f);
  simulator_keys(e, f);
  disturbance_keys(e, f);
  motion_keys(e, f);
  path_keys(e, f);
  controller_keys(e, f);
  view_keys(e, f);
  other_keys(e, f);
}

}  // namespace lab
