// Computed torque: the model cancels what makes the arm hard to steer.
//
//   tau = M(q) (a_wanted + Kp e + Kd e') + nle(q, v)     makes   e'' + Kd e' + Kp e = 0
//
// If that is so, the controlled arm is six independent masses on springs, whatever arm it is. So the second
// road is to simulate exactly those, with no robot at all.
#include <rbd/rbd.h>

#include <iostream>

#include "roads.h"

namespace {
using Eigen::VectorXd;
constexpr double kDt = 0.001, kKp = 100, kKd = 20;

struct Wanted {
  VectorXd q, v, a;
};

// Every joint swings at a frequency of its own.
Wanted sinusoids(double t) {
  Wanted w{VectorXd(6), VectorXd(6), VectorXd(6)};
  for (int k = 0; k < 6; ++k) {
    const double rate = 1 + 0.3 * k, size = 0.3;
    w.q[k] = size * std::sin(rate * t);
    w.v[k] = size * rate * std::cos(rate * t);
    w.a[k] = -size * rate * rate * std::sin(rate * t);
  }
  return w;
}
}  // namespace

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  rbd::Data data(model), robot(model);  // the controller's scratch and the robot's

  // all start away from the wanted place, at rest
  const VectorXd start = VectorXd::Constant(6, 0.2);
  VectorXd q = start, v = VectorXd::Zero(6);           // the arm
  VectorXd masses = start, rates = VectorXd::Zero(6);  // six masses
  VectorXd q_pd = start, v_pd = VectorXd::Zero(6);     // the arm under plain PD, same gains
  double apart = 0, error_ct = 0, error_pd = 0;
  for (int k = 0; k < 5000; ++k) {
    const Wanted w = sinusoids(k * kDt);
    const VectorXd a = w.a + kKp * (w.q - q) + kKd * (w.v - v);
    const VectorXd tau = rbd::crba(model, data, q) * a + rbd::nonLinearEffects(model, data, q, v);
    v += kDt * rbd::aba(model, robot, q, v, tau);
    q += kDt * v;

    rates += kDt * (w.a + kKp * (w.q - masses) + kKd * (w.v - rates));
    masses += kDt * rates;

    v_pd += kDt * rbd::aba(model, robot, q_pd, v_pd, kKp * (w.q - q_pd) + kKd * (w.v - v_pd));
    q_pd += kDt * v_pd;

    apart = std::max(apart, (q - masses).norm());
    if (k < 2500) continue;  // the start is forgotten by then
    error_ct = std::max(error_ct, (w.q - q).cwiseAbs().maxCoeff());
    error_pd = std::max(error_pd, (w.q - q_pd).cwiseAbs().maxCoeff());
  }
  std::cout << "largest error: " << error_ct << " rad with computed torque, " << error_pd << " with PD\n";

  Roads roads;
  roads.compare("the arm, six masses on springs: farthest apart", apart, 0, 1e-12);
  roads.compare("computed torque's error over PD's, at most a tenth", error_ct / error_pd, 0.05, 0.05);
  return roads.exit_code();
}
