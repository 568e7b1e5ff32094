#include "lab/check/check.h"

#include <rbd/model/near_names.h>
#include <rbd/rbd.h>

#include <algorithm>
#include <cmath>

#include "core/util/number.h"
#include "lab/check/unused.h"
#include "lab/evaluation/evaluate.h"
#include "lab/experiment/joints.h"
#include "procs/controller/controller.h"
#include "procs/planner/planner.h"
#include "procs/simulator/simulator.h"

namespace lab {
namespace {

constexpr int kSamples = 50;  // along the planned path

struct Worst {
  double ratio = 0, time = 0;
};

std::string warn(const Experiment& e, const std::string& key, const std::string& message) {
  try {
    fail(e, key, "warning: " + message);
  } catch (const ExperimentError& text) {
    return text.what();
  }
}

std::string percent(double share) { return number(std::round(1000 * share) / 10) + " %"; }

/// A name that is nearly one of the usual five would run beside the process that it was meant to replace.
void check_processes(const Experiment& e) {
  for (const auto& [name, command] : e.processes)
    for (const std::string usual : {"simulator", "planner", "controller", "logger", "renderer"})
      if (const int distance = rbd::editDistance(name, usual);
          distance > 0 && distance <= 2 && !name.starts_with(usual))
        fail(e, "processes." + name,
             "would run beside the usual processes; did you mean '" + usual + "'? (any other name is free)");
}

/// Disturbances that do not take place as the file says.
void check_disturbances(const Experiment& e, const simulator::Config& plant,
                        std::vector<std::string>& warnings) {
  const double dt = e.simulator.dt;
  if (const double delay = static_cast<double>(plant.sensors.delay) * dt;
      std::abs(delay - e.simulator.delay) > 1e-9 * dt)
    warnings.push_back(
        warn(e, "simulator.delay", "is not a whole number of steps; the delay is " + number(delay) + " s"));
  const auto late = [&](const std::string& key, size_t i, double time) {
    if (std::llround(time / dt) >= e.last_step())
      warnings.push_back(warn(e, key + "[" + std::to_string(i) + "].time",
                              number(time) + " s is after the end of the run: it never happens"));
  };
  for (size_t i = 0; i < e.simulator.pushes.size(); ++i)
    late("simulator.pushes", i, e.simulator.pushes[i].time);
  for (size_t i = 0; i < e.simulator.payloads.size(); ++i)
    late("simulator.payloads", i, e.simulator.payloads[i].time);
}

/// The loop around one reference, whatever the law: how the joint accelerations of the robot change with q and v, by
/// central differences of the controller's step. Errors of its own model are in it.
double loop_ratio(const rbd::Model& model, rbd::Data& data, const controller::Config& control,
                  const Reference& wanted, double h) {
  constexpr double kStep = 1e-6;  // rad, m; error of the slopes about 1e-9 of them
  controller::Config config = control;
  config.limit_effort = false;  // a command at its limit has no slope, until it is back
  controller::State state = controller::initial(config);
  RobotState at;
  const auto acceleration = [&](const Eigen::VectorXd& dq, const Eigen::VectorXd& dv) {
    at.q = rbd::integrate(model, wanted.q, dq);
    at.v = wanted.v + dv;
    state.memory.setZero();
    const Command command = controller::step(config, state, {.state = at, .reference = wanted}).command;
    return Eigen::VectorXd(rbd::aba(model, data, at.q, at.v, command.tau));
  };
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(model.nv);
  Eigen::MatrixXd A(model.nv, model.nv), D(model.nv, model.nv);
  for (int i = 0; i < model.nv; ++i) {
    const Eigen::VectorXd by = kStep * Eigen::VectorXd::Unit(model.nv, i);
    A.col(i) = (acceleration(by, none) - acceleration(-by, none)) / (2 * kStep);
    D.col(i) = (acceleration(none, by) - acceleration(none, -by)) / (2 * kStep);
  }
  return stability_ratio(A, D, h);
}

/// Stability along the planned path: of the control loop, of explicit damping and friction, and of soft stops.
void check_stability(const Experiment& e, const simulator::Config& plant, const planner::Config& plan,
                     const controller::Config* control, const rbd::Model& model,
                     std::vector<std::string>& warnings) {
  rbd::Data data(model);
  planner::State state = planner::initial(plan);
  Worst loop, friction, stops;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(model.nv),
                        drag =
                            plant.model.damping + plant.model.friction / rbd::kSlipSpeed;  // slope at v = 0
  Eigen::VectorXd stop_stiffness = none, stop_damping = none;
  for (const simulator::SoftStop& stop : plant.disturbances.stops) {
    stop_stiffness[stop.v] = stop.stiffness;
    stop_damping[stop.v] = stop.damping;
  }
  const bool euler = plant.integrator == simulator::Integrator::SemiImplicitEuler;
  const double h = e.simulator.dt * static_cast<double>(e.controller.every);
  const auto note = [](Worst& worst, double ratio, double time) {
    if (ratio > worst.ratio) worst = {ratio, time};
  };
  for (int i = 0; i <= kSamples; ++i) {
    const int64_t step = e.last_step() * i / kSamples;
    const Reference wanted = planner::step(plan, state, {.step = step}).reference;
    const double time = static_cast<double>(step) * e.simulator.dt;
    const Eigen::MatrixXd Minv = rbd::computeMinverse(model, data, wanted.q);
    if (control) note(loop, loop_ratio(model, data, *control, wanted, h), time);
    if (euler) note(friction, stability_ratio(Minv, none, drag, e.simulator.dt), time);
    if (!plant.disturbances.stops.empty())
      note(stops, stability_ratio(Minv, stop_stiffness, stop_damping, e.simulator.dt), time);
  }
  const auto judge = [&](const Worst& worst, const std::string& key, const std::string& what,
                         const std::string& cure) {
    if (worst.ratio > 0.5)
      warnings.push_back(warn(e, key,
                              what + " at " + percent(worst.ratio) +
                                  " of the limit of stability (t = " + number(worst.time) + " s)" +
                                  (worst.ratio >= 1 ? ": it will not hold" : "") + "; " + cure));
  };
  judge(loop, "controller.kd", "the gains are", "lower them, shorten dt or give the joints armature");
  judge(friction, "simulator.damping", "damping and friction are",
        "lower them, shorten dt or take integrator rk4");
  judge(stops, "simulator.limit_repulsion.stiffness", "the soft stops are",
        "lower stiffness and damping, shorten dt or give the joints armature");
}

/// Speeds beyond limits, and a motion that is longer than the run.
void check_motion(const Experiment& e, const planner::Config& plan, const rbd::Model& model,
                  std::vector<std::string>& warnings) {
  for (int i = 0; i < model.nv; ++i)
    if (plan.motion->peak_speed[i] > model.upperVelocityLimit[i] * (1 + 1e-9))
      warnings.push_back(warn(e, "planner.kind",
                              "joint '" + joint_at(model, i) + "' has to move at " +
                                  rounded(plan.motion->peak_speed[i]) + ", its limit is " +
                                  number(model.upperVelocityLimit[i]) + "; " + plan.kind->cure));
  if (const double end = static_cast<double>(e.last_step()) * e.simulator.dt;
      plan.motion->chosen_time && plan.motion->duration > end)
    warnings.push_back(warn(e, "simulator.duration",
                            "the motion takes " + rounded(plan.motion->duration) +
                                " s, and the run ends at " + number(end) + " s"));
}

}  // namespace

std::vector<Eigen::VectorXd> planned_poses(const Experiment& e, const rbd::Model& model, int count) {
  const planner::Config plan = planner::make_config(e, model);
  planner::State state = planner::initial(plan);
  std::vector<Eigen::VectorXd> poses;
  for (int i = 0; i < count; ++i)
    poses.push_back(
        planner::step(plan, state, {.step = e.last_step() * i / std::max(count - 1, 1)}).reference.q);
  return poses;
}

double spectral_radius(Eigen::MatrixXd A) {
  // Gelfand's formula: |A^k|^(1/k) for k = 2^30, by squaring. Each square is scaled to norm 1, and log_norm is that of A^k.
  // (Eigen's EigenSolver costs ten seconds of compile time, and nothing here needs the other eigenvalues.)
  double log_norm = 0;
  double k = 1;
  for (int i = 0; i <= 30; ++i, k *= 2) {
    const double norm = A.norm();
    if (norm == 0) return 0;
    if (!std::isfinite(norm)) return norm;
    log_norm += std::log(norm) / k;
    A /= norm;
    A = A * A;
  }
  return std::exp(log_norm);
}

double stability_ratio(const Eigen::MatrixXd& A, const Eigen::MatrixXd& D, double h) {
  return spectral_radius(h * D + (h * h / 2) * A) / 2;
}

double stability_ratio(const Eigen::MatrixXd& Minv, const Eigen::VectorXd& kp, const Eigen::VectorXd& damping,
                       double h) {
  return stability_ratio(Minv * kp.asDiagonal(), Minv * damping.asDiagonal(), h);
}

std::vector<std::string> check(const Experiment& e, const Robot& robot) {
  const rbd::Model& model = robot.model;
  const simulator::Config plant = simulator::make_config(e, model);
  const planner::Config plan = planner::make_config(e, model);
  // a controller process of the user's has its own kinds and gains
  const bool ours = !e.processes.contains("controller");
  const controller::Config control = ours ? controller::make_config(e, model) : controller::Config();
  check_processes(e);
  check_unused(e);
  check_expect(e, model);
  check_evaluation(e, model);
  if (!e.renderer.trace.empty()) named_frame(e, "renderer.trace", e.renderer.trace, model);
  if (!e.renderer.follow.empty()) named_frame(e, "renderer.follow", e.renderer.follow, model);

  std::vector<std::string> warnings;
  for (int i = 0; i < model.nv; ++i)
    if (model.upperEffortLimit[i] == 0 && model.lowerEffortLimit[i] == 0)
      warnings.push_back(
          warn(e, "robot.model",
               "joint '" + joint_at(model, i) + "' has an effort limit of 0: nothing can drive it"));
  if (const double off = std::abs(static_cast<double>(e.last_step()) * e.simulator.dt - e.simulator.duration);
      off > 1e-9 * e.simulator.duration)
    warnings.push_back(warn(e, "simulator.duration",
                            "is not a whole number of steps; the run takes " +
                                number(static_cast<double>(e.last_step()) * e.simulator.dt) + " s"));

  check_disturbances(e, plant, warnings);
  check_motion(e, plan, model, warnings);
  check_stability(e, plant, plan, ours ? &control : nullptr, model, warnings);
  // the robot's own come last, and of these what is only missing in pictures
  warnings.insert(warnings.end(), robot.warnings.begin(), robot.warnings.end());
  std::stable_partition(warnings.begin(), warnings.end(), [](const std::string& warning) {
    return warning.find(": mesh '") == std::string::npos;
  });
  return warnings;
}

}  // namespace lab
