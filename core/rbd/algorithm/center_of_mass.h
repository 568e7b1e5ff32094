// The centre of mass, of the whole robot and of what each joint carries; masses. World axes, SI units. The
// universe's own inertia (what is bolted to the ground) is left out. Throws std::runtime_error when the total
// mass is zero.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// World position (m): data.com[0]; total mass: data.mass[0]. With v also its velocity data.vcom[0], with a
// its acceleration data.acom[0] (gravity not included).
const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q);
const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                    const ConstVectorRef& v);
const Eigen::Vector3d& centerOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                    const ConstVectorRef& v, const ConstVectorRef& a);
void centerOfMass(const Model& model, Data& data, const ConstVectorRef& q, Eigen::Vector3d& com);

// The same for what every joint carries: data.com[i], vcom[i], acom[i], mass[i]; [0] is the whole robot.
// Where a joint carries no mass: of its origin.
void computeSubtreeCentersOfMass(const Model& model, Data& data, const ConstVectorRef& q,
                                 const ConstVectorRef& v, const ConstVectorRef& a);

// Masses (kg) that depend on no state: data.mass.
double computeTotalMass(const Model& model);
void computeSubtreeMasses(const Model& model, Data& data);

// 3 x nv, J v = velocity of the centre of mass: data.Jcom. Fills data.com[0] too.
const PaddedMatrix& jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q);
void jacobianCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q, MatrixRef J);

// The same for what one joint carries; zero where it carries no mass.
void jacobianSubtreeCenterOfMass(const Model& model, Data& data, const ConstVectorRef& q, JointIndex joint,
                                 MatrixRef J);

}  // namespace rbd
