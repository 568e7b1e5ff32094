// The factors of M that keep its zeros: M = U D U', U unit upper triangular, D diagonal. U(i, k) differs from
// zero only where dof i moves what dof k moves, so branches cost nothing. Source: Featherstone 2008,
// table 6.3 and section 6.5 (there M = L' D L, with L = U').
//
// Throws std::runtime_error naming the joint when M is singular.
#pragma once

#include "rbd/algorithm/kinematics.h"

namespace rbd::cholesky {

// data.U and data.D from data.M. Needs crba.
void decompose(const Model& model, Data& data);

// x := M^-1 x (nv). Needs decompose.
void solve(const Model& model, const Data& data, VectorRef x);

// x := M x, from the factors. Needs decompose.
void multiply(const Model& model, const Data& data, VectorRef x);

}  // namespace rbd::cholesky
