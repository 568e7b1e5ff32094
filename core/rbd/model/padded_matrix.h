// A column-major matrix whose columns start 64-byte aligned: what the kernels fill, read like any Eigen
// matrix.
//
// It is an Eigen::Map with an outer stride that is a multiple of 8, owning its memory. Copies are deep;
// copying to an Eigen::MatrixXd drops the padding.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>

namespace rbd {

class PaddedMatrix : public Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>> {
 public:
  using Base = Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>;

  PaddedMatrix() : PaddedMatrix(0, 0) {}
  PaddedMatrix(Eigen::Index rows, Eigen::Index cols)
      : Base(nullptr, rows, cols, Eigen::OuterStride<>(padded(rows))),
        memory_(std::calloc(static_cast<std::size_t>(padded(rows) * cols + 8), sizeof(double))) {
    if (!memory_) throw std::bad_alloc();
    reseat(aligned(), rows, cols);
  }
  PaddedMatrix(const PaddedMatrix& b) : PaddedMatrix(b.rows(), b.cols()) { Base::operator=(b); }
  PaddedMatrix(PaddedMatrix&& b) noexcept
      : Base(b.data(), b.rows(), b.cols(), Eigen::OuterStride<>(padded(b.rows()))),
        memory_(std::move(b.memory_)) {
    b.reseat(nullptr, 0, 0);
  }
  PaddedMatrix& operator=(const PaddedMatrix& b) { return *this = PaddedMatrix(b); }
  PaddedMatrix& operator=(PaddedMatrix&& b) noexcept {
    const Eigen::Index rows = b.rows(), cols = b.cols();
    memory_ = std::move(b.memory_);
    reseat(memory_ ? aligned() : nullptr, rows, cols);
    b.reseat(nullptr, 0, 0);
    return *this;
  }

 private:
  // calloc: pages of a large matrix that are never written take no memory
  struct Free {
    void operator()(void* p) const { std::free(p); }
  };
  static Eigen::Index padded(Eigen::Index n) { return n > 0 ? (n + 7) / 8 * 8 : 8; }
  double* aligned() const {
    return reinterpret_cast<double*>((reinterpret_cast<std::uintptr_t>(memory_.get()) + 63) / 64 * 64);
  }
  // Eigen's own way to change what a Map points at.
  void reseat(double* data, Eigen::Index rows, Eigen::Index cols) {
    new (static_cast<Base*>(this)) Base(data, rows, cols, Eigen::OuterStride<>(padded(rows)));
  }

  std::unique_ptr<void, Free> memory_;
};

}  // namespace rbd
