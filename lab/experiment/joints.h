// From "a number per joint" to vectors of a model. Only joints with one degree of freedom count: one
// number is for all of them, a list has one number for each in model order, a map names them. A floating
// base gets the fallback, unless a list has as many numbers as the whole vector. A joint that follows another
// has no number: it is not counted, and naming it is an error. Throws ExperimentError with the key's place.
#pragma once
#include <rbd/model/model.h>

#include <Eigen/Core>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/signals/signals.h"

namespace lab {

/// nv entries; `fallback` where nothing is given.
Eigen::VectorXd joint_vector(const Experiment&, const std::string& key, const JointValues&, const rbd::Model&,
                             double fallback);
/// nv entries; fallback[i] where nothing is given.
Eigen::VectorXd joint_vector(const Experiment&, const std::string& key, const JointValues&, const rbd::Model&,
                             const Eigen::VectorXd& fallback);

/// nq entries; `fallback` (nq) where nothing is given. Refuses what is outside the model's position limits,
/// and a quaternion (a planar joint's cos and sin) that is not of length 1 (within 1e-6; it is normalised).
Eigen::VectorXd configuration(const Experiment&, const std::string& key, const JointValues&,
                              const rbd::Model&, const Eigen::VectorXd& fallback);

/// Why a joint cannot be named where a number per joint is given: it follows another ("'x' follows 'y' .."), has
/// several degrees of freedom, or does not exist. "" if it can.
std::string joint_fault(const rbd::Model&, const std::string& name);

/// The frame that a key names. Throws ExperimentError with near names if there is none.
rbd::FrameIndex named_frame(const Experiment&, const std::string& key, const std::string& name,
                            const rbd::Model&);

/// Why a frame cannot be pushed, loaded or given a goal: it does not exist, or is fixed to the ground. "" if it can.
std::string frame_fault(const rbd::Model&, const std::string& name);

/// Name of the joint that velocity entry i belongs to.
const std::string& joint_at(const rbd::Model&, int i);

/// Clamps tau (nv) to the joints' effort limits, and to 0 for a floating base, which has no motors. `cut` (nv) marks the
/// clamped entries; when that begins there is an event `what` (for a base: "base_effort_ignored").
void clamp_effort(const rbd::Model&, const char* what, Eigen::VectorXd& tau, std::vector<bool>& cut,
                  std::vector<Event>&);

/// True if some joint has more than one degree of freedom: the base floats.
bool floats(const rbd::Model&);

}  // namespace lab
