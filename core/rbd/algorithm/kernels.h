// The kernels behind the public functions, on plain arrays. Compiled for double and for long double: tests
// measure the rounding error of double against long double.
//
// No checks here: the caller guarantees the sizes. All vectors are those of the kernels' tree (packed_joint.h).
// Rotors: abaKernel takes them; the callers of rneaKernel and crbaKernel add them. Matrices are column-major
// with the stride given. A kernel that can meet a singular inertia returns the dof (or -1), and the value in
// D.
#pragma once

#include "rbd/kernel/workspace.h"

namespace rbd::inner {

template <class Scalar>
void rneaKernel(const Model& model, Scratch<Scalar>& s, const Scalar* q, const Scalar* qd, const Scalar* qdd,
                Scalar* tau);
template <class Scalar>
void gravityKernel(const Model& model, Scratch<Scalar>& s, const Scalar* q, Scalar* tau);
template <class Scalar>
void crbaKernel(const Model& model, const int* dof_parent, Scratch<Scalar>& s, const Scalar* q, Scalar* M,
                int stride);
template <class Scalar>
int abaKernel(const Model& model, const double* rotor, Scratch<Scalar>& s, const Scalar* q, const Scalar* qd,
              const Scalar* tau, Scalar* qdd, Scalar& D);

}  // namespace rbd::inner
