#include "rbd/algorithm/all_terms.h"

#include "rbd/algorithm/center_of_mass.h"
#include "rbd/algorithm/centroidal.h"
#include "rbd/algorithm/coriolis.h"
#include "rbd/algorithm/crba.h"
#include "rbd/algorithm/energy.h"
#include "rbd/algorithm/jacobian.h"
#include "rbd/algorithm/minverse.h"
#include "rbd/algorithm/rnea.h"

namespace rbd {

void computeAllTerms(const Model& model, Data& data, const ConstVectorRef& q, const ConstVectorRef& v) {
  forwardKinematics(model, data, q, v);
  computeJointJacobiansTimeVariation(model, data, q, v);
  crba(model, data, q);
  computeMinverse(model, data, q);
  nonLinearEffects(model, data, q, v);
  computeGeneralizedGravity(model, data, q);
  computeCoriolisMatrix(model, data, q, v);
  jacobianCenterOfMass(model, data, q);
  computeCentroidalMapTimeVariation(model, data, q, v);
  computeMechanicalEnergy(model, data, q, v);
}

}  // namespace rbd
