#include "rbd/algorithm/inverse_kinematics.h"

#include <cmath>
#include <random>
#include <sstream>
#include <stdexcept>

#include "rbd/algorithm/argument_checks.h"
#include "rbd/algorithm/configuration.h"
#include "rbd/algorithm/ik_search.h"

namespace rbd {
namespace {

const char* const kName = "inverseKinematics";
constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[noreturn]] void fail(const std::string& what) {
  throw std::invalid_argument(std::string(kName) + ": " + what);
}

void check(const Model& model, const IkScratch& scratch, std::span<const FrameTarget> targets,
           const IkOptions& options, const VectorRef& q) {
  inner::checkInputs(kName, model, scratch.data, q);
  if (targets.empty()) fail("no target");
  if (6 * static_cast<Eigen::Index>(targets.size()) > scratch.e.size()) {
    fail(std::to_string(targets.size()) + " targets, this IkScratch was made for " +
         std::to_string(scratch.e.size() / 6));
  }
  for (const FrameTarget& target : targets) {
    inner::checkFrame(kName, model, target.frame);
    const std::string& name = model.frames[target.frame].name;
    // the bound keeps every square finite
    if (!(target.pose.translation().cwiseAbs().maxCoeff() <= 1e100))
      fail("the target position of frame '" + name + "' is not finite");
    if (target.rotation && !isRotation(target.pose.rotation()))
      fail("the target of frame '" + name + "' is not a rotation");
  }
  const auto positive = [](const char* what, double x) {
    if (!(x > 0 && x < kInfinity))
      fail(std::string(what) + " is " + std::to_string(x) + ", it must be positive");
  };
  positive("position_tolerance", options.position_tolerance);
  positive("rotation_tolerance", options.rotation_tolerance);
  positive("length", options.length);
  if (options.iterations < 0 || options.restarts < 0) fail("iterations and restarts must not be negative");
  for (int k = 0; k < model.nq; ++k) {
    if (!(model.lowerPositionLimit[k] <= model.upperPositionLimit[k]))
      fail("the position limits of q[" + std::to_string(k) + "] exclude each other");
  }
  if (options.rest.size() > 0) {
    inner::checkQ(kName, "rest", model, options.rest);
    inner::checkQuaternions(kName, model, options.rest);
  }
  if (options.rest_weight.size() > 0) {
    inner::checkV(kName, "rest_weight", model, options.rest_weight);
    if (options.rest_weight.minCoeff() < 0 || options.rest_weight.maxCoeff() > 1)
      fail("rest_weight must be between 0 and 1");
  }
}

}  // namespace

IkScratch::IkScratch(const Model& model, int targets) : data(model) {
  if (targets < 1) fail("an IkScratch is for at least one target");
  const Eigen::Index rows = 6 * targets;
  J.setZero(rows, model.nv);
  A.setZero(rows, rows);
  frame_J.setZero(6, model.nv);
  for (Eigen::VectorXd* x : {&e, &r}) x->setZero(rows);
  for (Eigen::VectorXd* x : {&dq, &dq_preferred, &gradient, &lower_step, &upper_step}) x->setZero(model.nv);
  for (Eigen::VectorXd* x : {&at, &next, &kept, &best}) x->setZero(model.nq);
  clamped.resize(static_cast<std::size_t>(model.nv));
}

IkResult inverseKinematics(const Model& model, IkScratch& s, std::span<const FrameTarget> targets,
                           const IkOptions& options, VectorRef q) {
  check(model, s, targets, options, q);
  inner::IkSearch search(model, s, targets, options);
  std::mt19937_64 engine(options.seed);
  bool too_far = false;
  for (const FrameTarget& target : targets)
    too_far = too_far || inner::outOfReach(model, target, options.position_tolerance);

  IkResult out;
  double least = kInfinity;
  s.at = q;
  for (int start = 0; start <= options.restarts && !out; ++start) {
    if (start > 0) randomConfiguration(model, engine, s.at);
    normalize(model, s.at);
    search.clamp(s.at);
    inner::IkErrors errors;
    IkStop stop = search.reach(errors);
    ++out.starts;
    if (errors.cost >= least) continue;
    JointIndex limit = 0;
    if (stop == IkStop::Converged) {
      if (options.rest.size() > 0) search.relax(errors);
    } else if (too_far) {
      stop = IkStop::OutOfReach;
    } else if (stop == IkStop::Stalled) {
      limit = search.limit();
      if (limit > 0) stop = IkStop::AtLimits;
    }
    least = errors.cost;
    s.best = s.at;
    out.stop = stop;
    out.position_error = errors.position;
    out.rotation_error = errors.rotation;
    out.limit = limit;
  }
  out.iterations = search.iterations();
  q = s.best;
  return out;
}

IkResult inverseKinematics(const Model& model, IkScratch& scratch, const FrameTarget& target,
                           const IkOptions& options, VectorRef q) {
  return inverseKinematics(model, scratch, std::span(&target, 1), options, q);
}

const char* ikStopName(IkStop stop) {
  switch (stop) {
    case IkStop::Converged:
      return "converged";
    case IkStop::OutOfReach:
      return "out of reach";
    case IkStop::AtLimits:
      return "joint limits in the way";
    case IkStop::Stalled:
      return "stalled at a singularity or a local minimum";
    case IkStop::IterationsUsedUp:
      return "iterations used up";
  }
  return "?";
}

std::string describe(const Model& model, const IkResult& result) {
  std::ostringstream out;
  out.precision(3);
  if (result.limit > 0) {
    out << "joint '" << model.names[result.limit] << "' is at its limit";
  } else {
    out << ikStopName(result.stop);
  }
  out << ": " << result.position_error << " m";
  if (result.rotation_error > 0) out << " and " << result.rotation_error << " rad";
  out << " from the target, after " << result.starts << (result.starts == 1 ? " start" : " starts") << " and "
      << result.iterations << " iterations";
  return out.str();
}

}  // namespace rbd
