// A vector that everyone may read and only its owner may change.
//
// Model keeps packed copies of what these lists say for the kernels; a silent write to one of them would make
// the two disagree. Change goes through the Model's setters.
#pragma once

#include <cstddef>
#include <vector>

namespace rbd {

template <class T, class Owner>
class ReadOnlyList {
 public:
  const T& operator[](std::size_t i) const { return items_[i]; }
  const T& at(std::size_t i) const { return items_.at(i); }
  const T& back() const { return items_.back(); }
  std::size_t size() const { return items_.size(); }
  bool empty() const { return items_.empty(); }
  auto begin() const { return items_.begin(); }
  auto end() const { return items_.end(); }
  operator const std::vector<T>&() const { return items_; }

 private:
  friend Owner;
  std::vector<T> items_;
};

}  // namespace rbd
