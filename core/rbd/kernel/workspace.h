// Scratch arrays of the kernels. One per Data; sizes are fixed when it is made.
//
// "World axes" below means: along the world's axes, about the CENTRE, a point near the robot (the first
// joint's origin), so that a robot far from the world's origin loses no precision. In this form
// inertias, forces and momenta simply add. "Local" means: in the joint's own kernel frame (z along its axis,
// see packed_joint.h).
#pragma once

#include <cstdint>
#include <vector>

#include "rbd/kernel/spatial_algebra.h"
#include "rbd/model/model.h"
#include "rbd/model/padded_matrix.h"

namespace rbd::inner {

template <class Scalar>
struct Scratch {
  explicit Scratch(const Model& model);

  // clang-format off
  // How many: of the kernels' tree (packed_joint.h). Written by: the function that fills it. SI units; p, centre in m.
  //                                            how many   what it holds                         written by
  std::vector<Scalar> sine, cosine;             // nq + 3   of every entry of q, used if an angle  sinesAndCosines
  std::vector<Pose<Scalar>> X;                  // bodies   joint in its parent, local             rneaKernel, forwardKinematics
  std::vector<Mat3<Scalar>> R;                  // bodies   kernel frame in world axes             worldPoses
  std::vector<Vec3<Scalar>> p;                  // bodies   its origin, from the centre            worldPoses
  Vec3<Scalar> centre = Vec3<Scalar>::zero();   // 1        in the world                           worldPoses
  std::vector<SpatialMotion<Scalar>> S;         // nv       motion subspace by dof, world axes     worldSubspace
  std::vector<RigidInertia<Scalar>> I;          // bodies   world axes; composite after a pass     worldInertias
  std::vector<RigidInertia<Scalar>> dI;         // bodies   rate of I, world axes                  computeCentroidalMapTimeVariation
  std::vector<SpatialMotion<Scalar>> v, a;      // bodies   local or world axes, as each kernel says
  std::vector<SpatialForce<Scalar>> f;          // bodies   the same
  std::vector<CoriolisInertia<Scalar>> B;       // bodies   world axes; composite after a pass     computeCoriolisMatrix, computeRNEADerivatives
  std::vector<SpatialMotion<Scalar>> Sd;        // nv       rate of S, world axes                  motionRates
  std::vector<SpatialMotion<Scalar>> Psid, Psidd;  // nv    (motion_rates.h), world axes           motionRates
  std::vector<ArticulatedInertia<Scalar>> IA;   // bodies   world axes                             aba, computeMinverse
  std::vector<SpatialForce<Scalar>> U;          // nv       IA S                                   articulate
  std::vector<Scalar> inverseD;                 // nv       1 / (S' U + rotor)                     articulate
  std::vector<Scalar> u;                        // nv       tau - S' f                             aba
  std::vector<Scalar> largestD;                 // bodies   of all dofs at and beyond the joint    articulate
  std::vector<Scalar> F, P;                     // 6 stride   a row a coordinate; P: per depth     computeMinverse
  // clang-format on
};

// Results of computeForwardKinematicsDerivatives that its getters read; names as in Scratch.
struct KeptRates {
  std::vector<SpatialMotion<double>> S, Sd, Psid, Psidd, v, a;
  Vec3<double> centre = Vec3<double>::zero();
  bool there = false;
};

struct Workspace {
  explicit Workspace(const Model& model);

  std::uint64_t topology;  // of the model this was made for
  // of the tree's dofs
  std::vector<int> dofParent;   // nv, the dof before this one on the way to the root, -1 = none
  std::vector<int> order;       // nv, dofs in depth-first order
  std::vector<int> subtreeEnd;  // nv, by position in `order`: one past the last position in its subtree
  std::vector<int> depth;       // nv, by position in `order`: number of ancestor dofs
  bool depthFirst = true;       // order is 0, 1, 2, ..
  int stride = 0;               // nv rounded up to 8
  std::vector<double> W;        // nv x stride, Minv in depth-first order where that is not the model's
  Scratch<double> scratch;
  KeptRates kept;
  std::vector<int> related;  // nv, ancestors and descendants of one dof
  std::vector<bool> inside;  // bodies, marks

  // of the user's dofs
  std::vector<int> eliminationParent;  // nv: which entries of M's factors can differ from zero (cholesky.h)
  std::vector<double> rotor;           // nv, inertia of the rotors (kg m^2 or kg)
  Eigen::VectorXd effort;              // nv
  // the tree's vectors and matrices; empty while no joint mimics another
  std::vector<double> q, v, a, tau;
  PaddedMatrix J, dJ, Jcom, Ag, M, M2;
};

}  // namespace rbd::inner
