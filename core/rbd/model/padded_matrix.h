// A column-major matrix whose columns start 64-byte aligned: what the kernels fill, read like any Eigen
// matrix.
//
// It is an Eigen::Map with an outer stride that is a multiple of 8, owning its memory. Copies are deep;
// copying to an Eigen::MatrixXd drops the padding.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <new>

namespace rbd {

class PaddedMatrix : public Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> {
 public:
  using Base = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  PaddedMatrix() : PaddedMatrix(0, 0) {}
  PaddedMatrix(Eigen::Index rows, Eigen::Index cols)
      : Base(nullptr, rows, cols, Eigen::OuterStride<>(padded(rows))),
        memory_(allocate(padded(rows) * cols)) {
    reseat(memory_.get(), rows, cols);
    std::fill_n(memory_.get(), padded(rows) * cols, 0.0);
  }
  PaddedMatrix(const PaddedMatrix& b) : PaddedMatrix(b.rows(), b.cols()) { Base::operator=(b); }
  PaddedMatrix(PaddedMatrix&& b) noexcept
      : Base(b.memory_.get(), b.rows(), b.cols(), Eigen::OuterStride<>(padded(b.rows()))),
        memory_(std::move(b.memory_)) {
    b.reseat(nullptr, 0, 0);
  }
  PaddedMatrix& operator=(const PaddedMatrix& b) { return *this = PaddedMatrix(b); }
  PaddedMatrix& operator=(PaddedMatrix&& b) noexcept {
    const Eigen::Index rows = b.rows(), cols = b.cols();
    memory_ = std::move(b.memory_);
    reseat(memory_.get(), rows, cols);
    b.reseat(nullptr, 0, 0);
    return *this;
  }

 private:
  struct Free {
    void operator()(double* p) const { ::operator delete[](p, std::align_val_t(64)); }
  };
  static Eigen::Index padded(Eigen::Index n) { return n > 0 ? (n + 7) / 8 * 8 : 8; }
  static double* allocate(Eigen::Index n) {
    return static_cast<double*>(
        ::operator new[](static_cast<std::size_t>(n) * sizeof(double), std::align_val_t(64)));
  }
  // Eigen's own way to change what a Map points at.
  void reseat(double* data, Eigen::Index rows, Eigen::Index cols) {
    new (static_cast<Base*>(this)) Base(data, rows, cols, Eigen::OuterStride<>(padded(rows)));
  }

  std::unique_ptr<double[], Free> memory_;
};

}  // namespace rbd
