// Configurations: adding a velocity, the difference of two, the way between, neutral and random ones.
//
// q has nq numbers, velocities nv. Differences and velocities live in the tangent space: for a free-flyer the
// body twist that leads from the first to the second in unit time. Quaternions (and a planar joint's cos,
// sin) need not be normalised on input (zero is refused), are on output. Source: Sola, Deray, Atchuthan, A
// micro Lie theory, 2018.
#pragma once

#include <cstdint>
#include <random>

#include "rbd/algorithm/kinematics.h"

namespace rbd {

// All angles and positions 0, quaternions 0 0 0 1. A limit that excludes 0 does not move it.
Eigen::VectorXd neutral(const Model& model);
void neutral(const Model& model, VectorRef q);

// Even between the position limits; where there is none: angles in [-pi, pi], positions in [-1, 1] m,
// quaternions even over all rotations. The same engine state gives the same bytes on every machine.
Eigen::VectorXd randomConfiguration(const Model& model, std::mt19937_64& engine);
// Between bounds (nq) of your own.
Eigen::VectorXd randomConfiguration(const Model& model, std::mt19937_64& engine, const ConstVectorRef& lower,
                                    const ConstVectorRef& upper);
Eigen::VectorXd randomConfiguration(const Model& model, std::uint64_t seed);
// From an engine of this thread with a fixed seed.
Eigen::VectorXd randomConfiguration(const Model& model);
void randomConfiguration(const Model& model, std::mt19937_64& engine, VectorRef q);

// q moved along v (nv) for unit time.
Eigen::VectorXd integrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v);
void integrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v, VectorRef out);

// The velocity that leads from q0 to q1 in unit time: integrate(q0, difference(q0, q1)) is q1.
Eigen::VectorXd difference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1);
void difference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, VectorRef out);

// The rate of the coordinates x(t) of integrate(q0, x(t)) while the robot moves with v (nv), to second order in x:
// v + [x, v] / 2 + [x, [x, v]] / 12. It is v itself where velocities are the rates of the numbers in q; `out` may be v.
// An integrator of order 4 needs no more. Source: Munthe-Kaas, High order Runge-Kutta methods on manifolds, 1999.
Eigen::VectorXd coordinateRate(const Model& model, const ConstVectorRef& x, const ConstVectorRef& v);
void coordinateRate(const Model& model, const ConstVectorRef& x, const ConstVectorRef& v, VectorRef out);

// integrate(q0, s * difference(q0, q1)): q0 at s = 0, q1 at s = 1.
Eigen::VectorXd interpolate(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, double s);
void interpolate(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, double s,
                 VectorRef out);

// The length of difference(q0, q1), and its square.
double distance(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1);
double squaredDistance(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1);

// Whether every joint stands alike, within `tol` per entry of the difference (q and -q are one rotation).
bool isSameConfiguration(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1,
                         double tol = 1e-12);

// Makes every quaternion, and every cos and sin, in q a unit one. isNormalized: whether they are.
void normalize(const Model& model, VectorRef q);
bool isNormalized(const Model& model, const ConstVectorRef& q, double tol = 1e-12);

// Which argument a derivative is taken in.
enum ArgumentPosition { ARG0 = 0, ARG1 = 1 };

// How the end integrate(q, v) moves (nv) when q (ARG0) or v (ARG1) does: nv x nv, tangent spaces throughout.
void dIntegrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v, MatrixRef J,
                ArgumentPosition argument);
Eigen::MatrixXd dIntegrate(const Model& model, const ConstVectorRef& q, const ConstVectorRef& v,
                           ArgumentPosition argument);

// How difference(q0, q1) changes when q0 (ARG0) or q1 (ARG1) moves: nv x nv.
void dDifference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, MatrixRef J,
                 ArgumentPosition argument);
Eigen::MatrixXd dDifference(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1,
                            ArgumentPosition argument);

}  // namespace rbd
