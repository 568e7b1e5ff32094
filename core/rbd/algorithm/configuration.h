// Configurations: adding a velocity, the difference of two, the way between, neutral and random ones.
//
// q has nq numbers, velocities nv. For a free-flyer the difference is the body twist that leads from the
// first to the second in unit time. Quaternions need not be normalised on input (zero is refused), are on
// output. Source: Sola, Deray, Atchuthan, A micro Lie theory, 2018.
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

// integrate(q0, s * difference(q0, q1)): q0 at s = 0, q1 at s = 1.
Eigen::VectorXd interpolate(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, double s);
void interpolate(const Model& model, const ConstVectorRef& q0, const ConstVectorRef& q1, double s,
                 VectorRef out);

// Makes every quaternion in q a unit one.
void normalize(const Model& model, VectorRef q);

}  // namespace rbd
