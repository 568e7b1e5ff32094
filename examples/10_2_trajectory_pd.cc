// A task from beginning to end: plan a cubic from rest to rest, follow it with PD, look at what came out.
#include <rbd/rbd.h>

#include <iostream>

#include "roads.h"

namespace {
using Eigen::VectorXd;

// q(t) = q0 + (q1 - q0) (3 s^2 - 2 s^3), s = t / T: at rest at both ends. After T it stays.
struct Cubic {
  VectorXd start, end;
  double T;
  double s(double t) const { return std::min(t / T, 1.0); }
  VectorXd position(double t) const { return start + (end - start) * s(t) * s(t) * (3 - 2 * s(t)); }
  VectorXd velocity(double t) const { return (end - start) * 6 * s(t) * (1 - s(t)) / T; }
};

struct Result {
  VectorXd q;
  double largest = 0;  // error of any joint at any time (rad)
};

Result follow(const rbd::Model& model, const Cubic& plan, double duration, bool carries_its_weight) {
  const double dt = 0.01, kp = 50, kd = 10;
  rbd::Data data(model);
  Result result{plan.start};
  VectorXd v = VectorXd::Zero(model.nv);
  for (int k = 0; k < std::lround(duration / dt); ++k) {
    const VectorXd error = plan.position(k * dt) - result.q;
    result.largest = std::max(result.largest, error.cwiseAbs().maxCoeff());
    VectorXd tau = kp * error + kd * (plan.velocity(k * dt) - v);
    if (carries_its_weight) tau += rbd::computeGeneralizedGravity(model, data, result.q);
    v += dt * rbd::aba(model, data, result.q, v, tau);
    result.q += dt * v;
  }
  return result;
}
}  // namespace

int main() {
  rbd::Model model;
  rbd::buildModels::manipulator(model);
  rbd::Data data(model);
  const Cubic plan{rbd::neutral(model), (VectorXd(6) << 0.5, 0.3, -0.4, 0.2, 0.5, -0.3).finished(), 2};

  Roads roads;
  const double t = 0.7, h = 1e-5;
  roads.compare("planned velocity, slope of planned position", plan.velocity(t),
                (plan.position(t + h) - plan.position(t - h)) / (2 * h), 1e-9);

  const Result plain = follow(model, plan, 10, false), helped = follow(model, plan, 10, true);
  std::cout << "largest error: " << plain.largest << " rad with PD, " << helped.largest
            << " with gravity added\n";
  // at rest the springs carry the weight: kp times the sag is gravity's effort, joint by joint
  roads.compare("kp times the sag, gravity where it rests", 50 * (plan.end - plain.q),
                rbd::computeGeneralizedGravity(model, data, plain.q), 1e-3);
  // and with gravity added nothing is left for the springs
  roads.compare("with gravity added, the goal", helped.q, plan.end, 1e-5);
  return roads.exit_code();
}
