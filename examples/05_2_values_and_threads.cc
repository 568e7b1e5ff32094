// Who owns a robot? A Model is a plain value: a copy is another robot, as with int. To share one, share it
// const; to compute at the same time, give each thread a Data of its own.
#include <rbd/rbd.h>

#include <iostream>
#include <memory>
#include <thread>
#include <vector>

#include "roads.h"

int main() {
  rbd::Model arm;
  rbd::buildModels::manipulator(arm);

  // a copy may be changed, the original does not notice
  rbd::Model loaded = arm;
  const rbd::Inertia tool = arm.inertias[6];
  loaded.setInertia(6, tool + rbd::Inertia::FromSphere(2, 0.05));
  std::cout << "tool: " << arm.inertias[6].mass() << " kg, with payload " << loaded.inertias[6].mass()
            << " kg\n";

  // shared_ptr counts the owners of the model; unique_ptr has one owner, and can be moved
  const auto shared = std::make_shared<const rbd::Model>(arm);
  const auto also = shared;  // NOLINT(performance-unnecessary-copy-initialization): it is another owner
  std::cout << "owners of the shared model: " << also.use_count() << "\n";
  auto mine = std::make_unique<rbd::Data>(*shared);
  const auto yours = std::move(mine);
  std::cout << "after the move my pointer is " << (mine ? "still set" : "empty") << "\n";

  // one const Model, four threads, four Data: all find what one thread finds alone
  const int threads = 4, states = 200;
  std::vector<Eigen::MatrixXd> found(threads, Eigen::MatrixXd(arm.nv, states));
  const auto work = [&](Eigen::MatrixXd& out) {
    rbd::Data data(*shared);
    std::mt19937_64 engine(1);
    for (int k = 0; k < states; ++k) {
      const Eigen::VectorXd q = rbd::randomConfiguration(*shared, engine),
                            zero = Eigen::VectorXd::Zero(arm.nv);
      out.col(k) = rbd::rnea(*shared, data, q, zero, zero);
    }
  };
  std::vector<std::jthread> pool;
  for (Eigen::MatrixXd& out : found) pool.emplace_back(work, std::ref(out));
  pool.clear();  // joins them
  Eigen::MatrixXd alone(arm.nv, states);
  work(alone);

  Roads roads;
  for (const Eigen::MatrixXd& out : found) roads.compare("efforts: in a thread, alone", out, alone, 0);
  roads.compare("the original's tool weighs what it did", arm.inertias[6].mass(), tool.mass(), 0);
  roads.compare("mass added to the copy", loaded.inertias[6].mass() - tool.mass(), 2, 1e-14);
  return roads.exit_code();
}
