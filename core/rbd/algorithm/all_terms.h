// All terms of the equation of motion in one call, for programs that need most of them.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// Fills what forwardKinematics(q, v), computeJointJacobiansTimeVariation, crba, computeMinverse,
// nonLinearEffects, computeGeneralizedGravity, computeCoriolisMatrix, centerOfMass(q, v),
// jacobianCenterOfMass, computeCentroidalMapTimeVariation and computeMechanicalEnergy fill.
void computeAllTerms(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v);

}  // namespace rbd
