// Forward dynamics: how does the robot move under these efforts? And with time in it: a simulation.
#include <rbd/rbd.h>

#include <Eigen/Cholesky>
#include <functional>
#include <iostream>

#include "roads.h"

namespace {
rbd::Model model;

struct Run {
  Eigen::VectorXd q = rbd::neutral(model), v = Eigen::VectorXd::Zero(6);
  double energy = 0, work = 0;  // gained, and put in by the efforts
};

// Semi-implicit Euler: first the velocity, then the place with the NEW velocity.
Run simulate(double dt, double duration, const std::function<Eigen::VectorXd(const Run&)>& law) {
  rbd::Data data(model);
  Run run;
  const auto energy = [&] {
    return rbd::computeKineticEnergy(model, data, run.q, run.v) +
           rbd::computePotentialEnergy(model, data, run.q);
  };
  const double start = energy();
  for (int k = 0; k < std::lround(duration / dt); ++k) {
    const Eigen::VectorXd tau = law(run), before = run.v;
    run.v += dt * rbd::aba(model, data, run.q, run.v, tau);
    run.q += dt * run.v;
    run.work += dt * tau.dot((before + run.v) / 2);
  }
  run.energy = energy() - start;
  return run;
}
}  // namespace

int main() {
  rbd::buildModels::manipulator(model);
  rbd::Data data(model);
  Roads roads;

  // accelerations by articulated bodies, and by solving M a = tau - nle
  Eigen::VectorXd q(6), v(6), tau(6);
  q << 0.4, -0.3, 0.6, 0.2, 0.8, -0.5;
  v << 0.3, -0.2, 0.5, 0.1, 0.4, -0.6;
  tau << 5, -10, 8, 1, 0.5, -0.2;
  const Eigen::MatrixXd M = rbd::crba(model, data, q);
  const Eigen::VectorXd a = M.llt().solve(tau - rbd::nonLinearEffects(model, data, q, v));
  roads.compare("aba, Cholesky of M", rbd::aba(model, data, q, v, tau), a, 1e-13);
  const Eigen::VectorXd minv_times = rbd::computeMinverse(model, data, q) * (tau - data.nle);
  roads.compare("aba, Minv times (tau - nle)", data.ddq, minv_times, 1e-12);

  // released, the arm falls and swings; no external work is done, so its energy stays, to first order in dt
  const auto free = [](const Run&) -> Eigen::VectorXd { return Eigen::VectorXd::Zero(6); };
  const double coarse = simulate(1e-3, 1, free).energy, fine = simulate(5e-4, 1, free).energy;
  std::cout << "energy drift: " << coarse << " J, at half the time step " << fine << " J\n";
  roads.compare("drift at dt over drift at dt / 2, two", coarse / fine, 2, 0.1);

  // springs and dampers at the joints: it comes to rest, sagging until kp * error carries the weight
  const double kp = 50, kd = 10;
  const Eigen::VectorXd goal = (Eigen::VectorXd(6) << 0.5, 0.3, -0.4, 0.2, 0.5, -0.3).finished();
  const auto pd = [&](const Run& run) -> Eigen::VectorXd { return kp * (goal - run.q) - kd * run.v; };
  const Run held = simulate(1e-3, 8, pd);
  std::cout << "error under PD: " << (goal - held.q).transpose() << "\n";
  roads.compare("kp * error at rest, gravity", kp * (goal - held.q),
                rbd::computeGeneralizedGravity(model, data, held.q), 1e-3);
  roads.compare("energy gained, work put in", held.energy, held.work, 0.02);
  return roads.exit_code();
}
