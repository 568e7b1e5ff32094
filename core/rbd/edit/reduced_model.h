// A robot with some of its joints locked: fewer numbers in q and v, the same body.
#pragma once

#include <vector>

#include "rbd/model/geometry.h"
#include "rbd/model/model.h"

namespace rbd {

// The model with `joints_to_lock` (in any order, of any kind) held where q (nq numbers of `model`) puts them.
// A locked joint becomes a frame of type FIXED_JOINT; what it carried is welded to the next joint above that
// moves, or to the ground. Everything else is kept: name, gravity, terms, the order of joints and frames,
// frame inertias, limits, rotors, damping and friction of the joints that move.
//
// A joint that follows a locked one is locked too, where it stands. A follower may be locked alone; its leader
// still moves.
//
// Every quantity equals that of the whole model at q with the locked joints at rest, but what is welded to
// the ground no longer counts as mass of the robot (total mass, centre of mass, potential energy).
//
// Throws std::invalid_argument: q of another size or with a zero quaternion, an index that does not exist, 0.
Model buildReducedModel(const Model& model, const std::vector<JointIndex>& joints_to_lock,
                        const Eigen::Ref<const Eigen::VectorXd>& q);

// And its shapes; `geometry` is the model's, `reduced_geometry` is replaced (they may be the same object).
Model buildReducedModel(const Model& model, const GeometryModel& geometry,
                        const std::vector<JointIndex>& joints_to_lock,
                        const Eigen::Ref<const Eigen::VectorXd>& q, GeometryModel& reduced_geometry);

}  // namespace rbd
