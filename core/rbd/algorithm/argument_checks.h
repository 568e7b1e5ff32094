// What every public function checks first, also in Release: that Data fits Model, and each argument's size
// and finiteness. The good path is a few compares; the messages are built out of line.
#pragma once

#include <bit>
#include <cstdint>

#include "rbd/algorithm/kinematics.h"

namespace rbd::inner {

[[noreturn]] void failData(const char* function, const Model& model, const Data& data);
[[noreturn]] void failVector(const char* function, const char* name, const double* x, Eigen::Index given,
                             int needed, const char* needed_name, const Model& model);
[[noreturn]] void failMatrix(const char* function, const char* name, const MatrixRef& m, int rows, int cols);
[[noreturn]] void failIndex(const char* function, const char* what, int index, int count, const Model& model);
[[noreturn]] void failWrench(const char* function, const std::string& frame);
[[noreturn]] void failOrder(const char* function, const char* what);
[[noreturn]] void failOverflow(const char* function, const Model& model, const Eigen::VectorXd& result);
[[noreturn]] void failSingular(const char* function, const Model& model, int dof, double d);

bool fits(const Model& model, const Data& data);

inline void checkData(const char* function, const Model& model, const Data& data) {
  if (!fits(model, data)) failData(function, model, data);
}

// Infinity and NaN are the numbers whose exponent has every bit set.
inline bool allFinite(const double* x, Eigen::Index n) {
  bool finite = true;
  for (Eigen::Index i = 0; i < n; ++i) {
    constexpr std::uint64_t kExponent = 0x7FF0000000000000;
    finite &= (std::bit_cast<std::uint64_t>(x[i]) & kExponent) != kExponent;
  }
  return finite;
}

inline void checkQ(const char* function, const char* name, const Model& model, const ConstVectorRef& q) {
  if (q.size() != model.nq || !allFinite(q.data(), q.size())) {
    failVector(function, name, q.data(), q.size(), model.nq, "nq", model);
  }
}

inline void checkV(const char* function, const char* name, const Model& model, const ConstVectorRef& v) {
  if (v.size() != model.nv || !allFinite(v.data(), v.size())) {
    failVector(function, name, v.data(), v.size(), model.nv, "nv", model);
  }
}

// Throws when a quaternion in q is zero; models without one pass at once.
void checkQuaternions(const char* function, const Model& model, const ConstVectorRef& q);

inline void checkInputs(const char* function, const Model& model, const Data& data, const ConstVectorRef& q) {
  checkData(function, model, data);
  checkQ(function, "q", model, q);
  if (model.nq != model.nv) checkQuaternions(function, model, q);
}

inline void checkInputs(const char* function, const Model& model, const Data& data, const ConstVectorRef& q,
                        const char* name, const ConstVectorRef& v) {
  checkInputs(function, model, data, q);
  checkV(function, name, model, v);
}

inline void checkInputs(const char* function, const Model& model, const Data& data, const ConstVectorRef& q,
                        const char* name, const ConstVectorRef& v, const char* name2,
                        const ConstVectorRef& a) {
  checkInputs(function, model, data, q, name, v);
  checkV(function, name2, model, a);
}

// An output: only its size matters.
inline void checkOut(const char* function, const char* name, const Model& model, const VectorRef& out, int n,
                     const char* needed_name) {
  if (out.size() != n) failVector(function, name, nullptr, out.size(), n, needed_name, model);
}

inline void checkOut(const char* function, const char* name, const MatrixRef& m, int rows, int cols) {
  if (m.rows() != rows || m.cols() != cols) failMatrix(function, name, m, rows, cols);
}

// A result: finite inputs can still be too large.
inline void checkResult(const char* function, const Model& model, const Eigen::VectorXd& result) {
  if (!allFinite(result.data(), result.size())) failOverflow(function, model, result);
}

inline void checkFrame(const char* function, const Model& model, FrameIndex frame) {
  if (frame < 0 || frame >= model.nframes) failIndex(function, "frame", frame, model.nframes, model);
}

inline void checkJoint(const char* function, const Model& model, JointIndex joint) {
  if (joint < 0 || joint >= model.njoints) failIndex(function, "joint", joint, model.njoints, model);
}

}  // namespace rbd::inner
