// A program outside of the project: a robot from code and one from URDF, inverse and forward dynamics.
#include <rbd/rbd.h>
#include <rbd/urdf/urdf.h>

#include <cstdio>

namespace {

const char* const kPendulum =
    "<robot name='pendulum'><link name='base'/><link name='rod'><inertial><origin xyz='0 0 -0.5'/><mass "
    "value='2'/>"
    "<inertia ixx='0.1' iyy='0.1' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial></link>"
    "<joint name='hinge' type='continuous'><parent link='base'/><child link='rod'/><axis xyz='0 1 "
    "0'/></joint></robot>";

// Forward dynamics undo inverse dynamics, and M a + nle is the same effort.
double closure(const rbd::Model& model) {
  rbd::Data data(model);
  const Eigen::VectorXd q = rbd::randomConfiguration(model, 7),
                        v = Eigen::VectorXd::LinSpaced(model.nv, -1, 1),
                        a = Eigen::VectorXd::LinSpaced(model.nv, 1, 3);
  const Eigen::VectorXd tau = rbd::rnea(model, data, q, v, a);
  const Eigen::VectorXd sum = rbd::crba(model, data, q) * a + rbd::nonLinearEffects(model, data, q, v);
  const Eigen::VectorXd back = rbd::aba(model, data, q, v, tau);
  return std::max((back - a).norm(), (sum - tau).norm() / tau.norm());
}

}  // namespace

int main() {
  rbd::Model humanoid, pendulum;
  rbd::buildModels::humanoid(humanoid);
  rbd::urdf::buildModelFromXML(kPendulum, pendulum);
  rbd::Data data(pendulum);
  const Eigen::VectorXd q = Eigen::VectorXd::Constant(1, 0.3), zero = Eigen::VectorXd::Zero(1);
  // falls like a pendulum of 2 kg, 0.5 m and 0.1 kg m^2 about its middle
  const double falls = rbd::aba(pendulum, data, q, zero, zero)[0];
  const double by_hand = -2 * 9.81 * 0.5 * std::sin(0.3) / (0.1 + 2 * 0.25);
  const double worst = std::max({closure(humanoid), closure(pendulum), std::abs(falls - by_hand)});
  std::printf("humanoid nv %d, pendulum nv %d, largest error %.1e\n", humanoid.nv, pendulum.nv, worst);
  return worst < 1e-9 ? 0 : 1;
}
