// A controller of one's own in C++: a law, one row that names it, and a main of three lines. It takes the controller's
// place in any experiment (docs/extend.md):
//
//     controller: {kind: pid, kp: 300, kd: 60}
//     processes: {controller: build/release/examples/own_controller}
//
// PID: an integral takes over what a PD leaves to its error, such as the weight of the arm, without knowing a model.
#include "lab/run/shell.h"
#include "procs/controller/role.h"

namespace {

using namespace lab::controller;

constexpr double kIntegral = 150;  // Nm/(rad s)

// tau = kp e + kd e' + ki (integral of e). A law is a pure function: what it remembers stands in the state, nowhere
// else, so that a restart or a replay of the log comes to the same numbers.
void pid(const Config& config, State& state, const Input&, Eigen::VectorXd& tau) {
  state.memory += config.period * state.e;
  tau = state.gains.kp.cwiseProduct(state.e) + state.gains.kd.cwiseProduct(state.e_dot) +
        kIntegral * state.memory;
}

constexpr Kind kMine[] = {{"pid", "tau = kp e + kd e' + 150 (integral of e)", pid}};

}  // namespace

int main(int argc, char** argv) {
  return lab::follower_main(argc, argv, lab::kController,
                            [](lab::FollowerConfig config, lab::Publish publish) {
                              return make_role(std::move(config), std::move(publish), kMine);
                            });
}
