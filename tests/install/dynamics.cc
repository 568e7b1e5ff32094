// What a user's file costs to compile: everything included, the three great algorithms called.
#include <rbd/rbd.h>

double effort(const rbd::Model& model, const Eigen::VectorXd& q, const Eigen::VectorXd& v) {
  rbd::Data data(model);
  const Eigen::VectorXd tau = rbd::rnea(model, data, q, v, v);
  return tau[0] + rbd::aba(model, data, q, v, tau)[0] + rbd::crba(model, data, q)(0, 0);
}
