// The kernels behind the public functions, on plain arrays. Compiled for double and for long double: the
// tests measure the rounding error of the one with the other.
//
// No checks here: sizes are the caller's. All vectors are those of the kernels' tree (packed_joint.h).
// Rotors: abaKernel takes them; the callers of rneaKernel and crbaKernel add them. Matrices are column-major
// with the stride given. A kernel that can meet a singular inertia returns the dof (or -1), and the value in
// D.
#pragma once

#include "rbd/kernel/workspace.h"

namespace rbd::inner {

template <class S>
void rneaKernel(const Model& model, Scratch<S>& s, const S* q, const S* qd, const S* qdd, S* tau);
template <class S>
void gravityKernel(const Model& model, Scratch<S>& s, const S* q, S* tau);
template <class S>
void crbaKernel(const Model& model, const int* dof_parent, Scratch<S>& s, const S* q, S* M, int stride);
template <class S>
int abaKernel(const Model& model, const double* rotor, Scratch<S>& s, const S* q, const S* qd, const S* tau,
              S* qdd, S& D);

}  // namespace rbd::inner
