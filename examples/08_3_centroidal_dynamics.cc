// The robot as a whole: where its centre of mass is, its momentum, and how fast that changes.
#include <rbd/rbd.h>

#include <Eigen/SVD>
#include <iostream>

#include "roads.h"

int main() {
  rbd::Model model;
  rbd::buildModels::humanoid(model);
  rbd::Data data(model);
  std::mt19937_64 engine(5);
  const Eigen::VectorXd q = rbd::randomConfiguration(model, engine);
  const Eigen::VectorXd v = rbd::difference(model, q, rbd::randomConfiguration(model, engine)) / 4;

  // a body is a point in this: no rotation, so the Jacobian of the centre of mass has three rows
  const Eigen::Vector3d com = rbd::centerOfMass(model, data, q, v);
  const Eigen::Vector3d vcom = data.vcom[0];
  const Eigen::MatrixXd Jcom = rbd::jacobianCenterOfMass(model, data, q);
  std::cout << "centre of mass " << com.transpose() << ", moving with " << vcom.transpose() << "\n";
  Roads roads;
  roads.compare("velocity of the centre of mass, Jcom v", vcom, Jcom * v, 1e-13);
  const double h = 1e-6;
  const Eigen::Vector3d later = rbd::centerOfMass(model, data, rbd::integrate(model, q, h * v));
  const Eigen::Vector3d sooner = rbd::centerOfMass(model, data, rbd::integrate(model, q, -h * v));
  roads.compare("the same, from where it was and will be", vcom, (later - sooner) / (2 * h), 1e-8);

  // momentum: linear part mass times velocity; angular part about the centre of mass, added up over the
  // bodies
  rbd::forwardKinematics(model, data, q, v);
  const rbd::Force hg = rbd::computeCentroidalMomentum(model, data);
  const double mass = data.mass[0];
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();
  for (rbd::JointIndex i = 1; i < model.njoints; ++i) {
    const rbd::Force h_body = data.oMi[i].act(model.inertias[i] * data.v[i]);  // about the world's origin
    spin += h_body.angular() - com.cross(h_body.linear());
  }
  std::cout << "momentum: linear " << hg.linear().transpose() << ", angular " << hg.angular().transpose()
            << "\n";
  roads.compare("linear momentum, mass times velocity", hg.linear(), mass * vcom, 1e-11);
  roads.compare("angular momentum, summed over bodies", hg.angular(), spin, 1e-11);

  // thrown into the air with limp joints: gravity changes the linear momentum, nothing changes the angular
  // one
  model.armature.setZero();
  const Eigen::VectorXd a = rbd::aba(model, data, q, v, Eigen::VectorXd::Zero(model.nv));
  const rbd::Force dhg = rbd::computeCentroidalMomentumTimeVariation(model, data, q, v, a);
  roads.compare("rate of linear momentum in flight, weight", dhg.linear(), mass * model.gravity.linear(),
                1e-8);
  roads.compare("rate of angular momentum in flight, 0", dhg.angular(), Eigen::Vector3d::Zero(), 1e-8);

  // 36 joint velocities for 3 numbers: of all that move the centre of mass so, the shortest (least squares)
  const Eigen::Vector3d wanted(0.1, 0, 0.05);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(Jcom, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd shortest = svd.solve(wanted);
  roads.compare("Jcom times the shortest solution, wanted", Jcom * shortest, wanted, 1e-14);
  const Eigen::VectorXd by_normal_equations = Jcom.transpose() * (Jcom * Jcom.transpose()).inverse() * wanted;
  roads.compare("shortest, by J' (J J')^-1", shortest, by_normal_equations, 1e-13);
  return roads.exit_code();
}
