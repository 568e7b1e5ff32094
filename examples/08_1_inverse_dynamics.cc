// Inverse dynamics: which efforts give this motion?   tau = M(q) a + C(q, v) v + g(q)
#include <rbd/rbd.h>

#include <iostream>

#include "roads.h"

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  rbd::Data data(model);
  Eigen::VectorXd q = rbd::neutral(model), v(6), a(6);
  v << 0.3, -0.2, 0.5, 0.1, 0.4, -0.6;
  a << 1.0, 0.5, -0.5, 0.2, 0.3, 0.8;
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(6);

  // standing still costs effort too: only a vertical axis feels no gravity
  const Eigen::VectorXd g = rbd::computeGeneralizedGravity(model, data, q);
  std::cout << "gravity at neutral: " << g.transpose() << "\n";
  Roads roads;
  roads.compare("gravity about the vertical axis, 0", g[0], 0, 1e-14);
  // the lever law: at neutral the forearm is level; about the shoulder each link pulls with m g times its
  // distance
  double lever = 0;
  rbd::forwardKinematics(model, data, q);
  for (rbd::JointIndex i = 2; i < model.njoints; ++i) {
    const Eigen::Vector3d centre = data.oMi[i].act(model.inertias[i].lever());
    lever += model.inertias[i].mass() * 9.81 * (centre.x() - data.oMi[2].translation().x());
  }
  roads.compare("gravity at the shoulder, weights times levers", g[1], -lever, 1e-13);

  // the same at any pose: gravity is the slope of potential energy
  q << 0.4, -0.3, 0.6, 0.2, 0.8, -0.5;
  const Eigen::VectorXd gravity = rbd::computeGeneralizedGravity(model, data, q);
  Eigen::VectorXd slope(6);
  for (int k = 0; k < 6; ++k) {
    const Eigen::VectorXd step = 1e-5 * Eigen::VectorXd::Unit(6, k);
    slope[k] = (rbd::computePotentialEnergy(model, data, q + step) -
                rbd::computePotentialEnergy(model, data, q - step)) /
               2e-5;
  }
  roads.compare("gravity, slope of potential energy", gravity, slope, 1e-8);

  // in one pass (RNEA), and put together from its parts
  const Eigen::VectorXd tau = rbd::rnea(model, data, q, v, a);
  const Eigen::MatrixXd M = rbd::crba(model, data, q);
  const Eigen::VectorXd nle = rbd::nonLinearEffects(model, data, q, v);
  std::cout << "efforts: " << tau.transpose() << "\n  inertia: " << (M * a).transpose()
            << "\n  gravity: " << gravity.transpose() << "\n  rest:    " << (nle - gravity).transpose()
            << "\n";
  roads.compare("rnea, M a + nle", tau, M * a + nle, 1e-13);
  roads.compare("nle at rest, gravity", rbd::nonLinearEffects(model, data, q, zero), gravity, 1e-13);

  // a column of M is what rnea says about one joint accelerating alone
  const Eigen::VectorXd column = rbd::rnea(model, data, q, zero, Eigen::VectorXd::Unit(6, 2)) - gravity;
  roads.compare("column of M, rnea with one acceleration", M.col(2), column, 1e-13);
  // Minv is the inverse: one multiplies by it
  const Eigen::MatrixXd Minv = rbd::computeMinverse(model, data, q);
  roads.compare("Minv M, identity", Minv * M, Eigen::MatrixXd::Identity(6, 6), 1e-13);
  return roads.exit_code();
}
