// Inverse kinematics: a configuration that brings frames where they are wanted, inside the joint limits.
//
// Damped least squares: each step minimises |e - J dq|^2 + lambda |dq|^2 over the dofs that are not held by a
// limit; e stacks the position errors (m) and, times `length`, the rotation errors (rad). lambda is the
// squared error itself times a factor that follows how well the last step's reduction was predicted: it vanishes at a
// solution (so convergence is fast there) and grows at singularities. Works in the tangent space, with every
// kind of joint, mimic and floating base.
// Sources: Wampler 1986 and Nakamura, Hanafusa 1986 (damping); Sugihara, Solvability-unconcerned inverse
// kinematics by the Levenberg-Marquardt method, 2011 (lambda from the error); Nielsen, Damping parameter in
// Marquardt's method, 1999 (the factor); Bertsekas, Projected Newton methods, 1982 (limits).
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// Where a frame is wanted.
struct FrameTarget {
  FrameIndex frame = 0;
  SE3 pose;              // in the world
  bool rotation = true;  // false: only the position counts
};

struct IkOptions {
  double position_tolerance = 1e-6;  // m, of every target
  double rotation_tolerance = 1e-6;  // rad
  int iterations = 200;              // from one start, at most (each is one or more kinematics passes)
  int restarts = 30;                 // from random configurations, while the starts before have failed
  std::uint64_t seed = 0;            // of these
  double length = 0.5;               // m: a rotation error of 1 rad counts like this distance
  // Once the targets are met, freedom that is left takes q towards `rest` (nq; empty: nowhere), each dof as
  // much as its weight between 0 and 1 says (nv; empty: 1): to a minimum of sum weight difference(q, rest)^2.
  Eigen::VectorXd rest, rest_weight;
};

// Why it stopped; all but Converged leave the nearest configuration that was found.
enum class IkStop {
  Converged,         // every target within tolerance
  OutOfReach,        // proven: a target is farther from its first joint than the joints behind it can span
  AtLimits,          // no step comes nearer, because joints are at their limits
  Stalled,           // it comes no nearer (position_tolerance / 10 in 10 iterations): a singularity, or a
                     // local minimum between targets
  IterationsUsedUp,  // it still came nearer
};

// "converged", "out of reach" ..
const char* ikStopName(IkStop stop);

struct [[nodiscard]] IkResult {
  IkStop stop = IkStop::Stalled;
  double position_error = std::numeric_limits<double>::infinity();  // m, largest of the targets, at q
  double rotation_error = 0;  // rad, the same; 0 when no target asks for a rotation
  JointIndex limit = 0;       // AtLimits: the joint that would have to go on the most; else 0
  int iterations = 0;         // of all starts together
  int starts = 0;
  explicit operator bool() const { return stop == IkStop::Converged; }
};

// One line for people: "joint 'elbow' is at its limit: 0.12 m and 0.3 rad from the target, after 31 starts
// ..".
std::string describe(const Model& model, const IkResult& result);

// Scratch for one thread, for up to `targets` targets at once.
struct IkScratch {
  explicit IkScratch(const Model& model, int targets = 1);

  Data data;
  Eigen::MatrixXd J, A;                    // 6 targets x nv, square; all rows of a target, used or not
  Eigen::MatrixXd frame_J;                 // 6 x nv
  Eigen::VectorXd e, r;                    // 6 targets: error, right-hand side
  Eigen::VectorXd dq, dq_preferred;        // nv: step; the step preferred where targets leave freedom
  Eigen::VectorXd gradient;                // nv: J' e
  Eigen::VectorXd lower_step, upper_step;  // nv: room to the limits
  Eigen::VectorXd at, next, kept, best;    // nq
  std::vector<char> clamped;               // nv: the step ends at a limit
};

// q: the start, and then the answer; always finite and, where limits bound it, within them.
// Throws std::invalid_argument for wrong sizes, indices and options; fails by its result.
IkResult inverseKinematics(const Model& model, IkScratch& scratch, std::span<const FrameTarget> targets,
                           const IkOptions& options, VectorRef q);
IkResult inverseKinematics(const Model& model, IkScratch& scratch, const FrameTarget& target,
                           const IkOptions& options, VectorRef q);

}  // namespace rbd
