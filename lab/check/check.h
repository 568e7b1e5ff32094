// What can be said about an experiment before it runs: what cannot run, and warnings.
#pragma once
#include <string>
#include <vector>

#include "lab/experiment/robot.h"

namespace lab {

/// Builds the config of every step and checks `expect`: throws ExperimentError for what cannot run. Returns
/// warnings for what can run but probably should not, each one line: unstable gains, speeds beyond limits, ..
std::vector<std::string> check(const Experiment&, const Robot&);

/// Configurations along what is planned, first and last step included: `count` of them, evenly in time.
std::vector<Eigen::VectorXd> planned_poses(const Experiment&, const rbd::Model&, int count);

/// The largest magnitude of an eigenvalue of a square matrix.
double spectral_radius(Eigen::MatrixXd);

/// How close a sampled control loop is to instability: 1 = the limit, beyond which it explodes. With x'' = A x + D x'
/// around the reference (no matter where they come from), stepped with time h: half the largest |eigenvalue| of
/// h D + h^2 A / 2. That is exact for the mode that alternates from step to step, which is what stiff gains do.
double stability_ratio(const Eigen::MatrixXd& A, const Eigen::MatrixXd& D, double h);

/// How close a sampled PD (or explicit damping) is to instability: 1 = the limit, beyond which it explodes.
/// With M x'' = -Kp x - D x' stepped by semi-implicit Euler with time h, each mode needs h D/M + h^2 Kp/(2 M)
/// < 2; this is the largest of them over 2: half the largest eigenvalue of M^-1 (h D + h^2 Kp / 2).
double stability_ratio(const Eigen::MatrixXd& Minv, const Eigen::VectorXd& kp, const Eigen::VectorXd& damping,
                       double h);

}  // namespace lab
