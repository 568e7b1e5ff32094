// Results and scratch of the algorithms for one Model: one Data per thread.
//
// Every algorithm says which field holds its answer. Nothing allocates after construction. A field keeps its
// last value until an algorithm that writes it is called again; before that it is zero (poses: identity).
// Data made for another model, or before the model was extended, is refused by every algorithm (by its
// sizes). It keeps no pointer to its Model.
#pragma once

#include <memory>
#include <vector>

#include "rbd/model/model.h"
#include "rbd/model/padded_matrix.h"

namespace rbd {

namespace inner {
struct Workspace;
}

// The numbers of one joint inside Data::q_in and Data::v_in (as of the last forwardKinematics).
class JointData {
 public:
  Eigen::Map<const Eigen::VectorXd> joint_q() const { return {q_, nq_}; }
  Eigen::Map<const Eigen::VectorXd> joint_v() const { return {v_, nv_}; }

 private:
  friend struct Data;
  const double *q_ = nullptr, *v_ = nullptr;
  Eigen::Index nq_ = 0, nv_ = 0;
};

// clang-format off
// What a Data holds for its reader, and the algorithm that writes it. n = model.nv.
struct DataFields {
  // poses and motions
  std::vector<SE3> oMi;     // njoints, world pose of each joint's frame        forwardKinematics, computeJointJacobians
  std::vector<SE3> oMf;     // nframes, world pose of each frame                forwardKinematics, updateFramePlacements
  std::vector<Motion> v, a; // njoints, LOCAL velocity, spatial acceleration    forwardKinematics(q, v[, a])
  Eigen::VectorXd q_in, v_in, a_in;  // nq, n, n: inputs of the last            forwardKinematics
  int kinematics_order = -1;         // of these: -1 nothing, 0 q, 1 q and v, 2 all

  // Jacobians, angular rows first
  PaddedMatrix J;           // 6 x n, column k: motion of dof k in WORLD        computeJointJacobians
  PaddedMatrix dJ;          // 6 x n, its rate                                  computeJointJacobiansTimeVariation

  // dynamics
  PaddedMatrix M;           // n x n, joint-space inertia, both sides           crba
  PaddedMatrix Minv;        // n x n, its inverse, both sides                   computeMinverse, computeABADerivatives
  PaddedMatrix C;           // n x n, C v = nle - g, dM/dt - 2C skew            computeCoriolisMatrix
  PaddedMatrix U;           // n x n, unit upper triangular, M = U D U'         cholesky::decompose
  Eigen::VectorXd D;        // n                                                cholesky::decompose
  Eigen::VectorXd tau;      // n, joint efforts                                 rnea, computeStaticTorque
  Eigen::VectorXd ddq;      // n, joint accelerations                           aba
  Eigen::VectorXd nle;      // n, Coriolis, centrifugal and gravity efforts     nonLinearEffects
  Eigen::VectorXd g;        // n, gravity efforts                               computeGeneralizedGravity

  // their derivatives, tangent space: row i, column j is d (entry i) / d (dof j)
  PaddedMatrix dtau_dq, dtau_dv;  // n x n                                      computeRNEADerivatives
  PaddedMatrix ddq_dq, ddq_dv;    // n x n (ddq_dtau is Minv)                   computeABADerivatives

  // centre of mass, momentum, energy; [0]: the whole robot, [i]: what joint i carries
  std::vector<Eigen::Vector3d> com, vcom, acom;  // njoints, world (m, m/s, m/s^2)  centerOfMass(q[, v[, a]])
  std::vector<double> mass;       // njoints (kg), the universe's own left out  centerOfMass, computeTotalMass
  PaddedMatrix Jcom;              // 3 x n                                      jacobianCenterOfMass
  PaddedMatrix Ag, dAg;           // 6 x n, hg = Ag v, dhg = Ag a + dAg v       computeCentroidalMap[TimeVariation]
  Force hg, dhg;                  // world axes, about the centre of mass       computeCentroidalMomentum[TimeVariation]
  double kinetic_energy = 0, potential_energy = 0;  // J                        computeKineticEnergy, computePotentialEnergy
  double mechanical_energy = 0;                     // J, their sum             computeMechanicalEnergy
};
// clang-format on

struct Data : DataFields {
  explicit Data(const Model& model);
  ~Data();
  Data(const Data& other);
  Data(Data&& other) noexcept;
  Data& operator=(const Data& other);
  Data& operator=(Data&& other) noexcept;

  std::vector<JointData> joints;  // njoints

  // The kernels' own arrays; see kernel/workspace.h.
  inner::Workspace& work() const { return *work_; }
  bool movedFrom() const { return !work_; }

 private:
  void rebase();
  std::unique_ptr<inner::Workspace> work_;
};

}  // namespace rbd
