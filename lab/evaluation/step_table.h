// The steps of a run, as many as there are: the first in memory, the others in a file without a name, so that memory does
// not grow with the length of a run.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "lab/signals/signals.h"

namespace lab {

struct RunStep {
  RobotState state;          ///< the true one
  Reference reference;       ///< for the same step
  double stored_energy = 0;  ///< J, in addition to the model's own (procs/simulator/replay.h)
  double external_work = 0;  ///< J, by disturbances, over the step that led here
};

/// Rows of numbers. Vectors have the sizes of the first row.
class StepTable {
 public:
  StepTable() = default;
  /// Rows beyond that go to a file in $TMPDIR, or /var/tmp, that is gone with the table.
  explicit StepTable(size_t bytes_in_memory) : bytes_in_memory_(bytes_in_memory) {}
  StepTable(const StepTable& other);
  StepTable(StepTable&& other) noexcept;
  StepTable& operator=(StepTable other) noexcept;
  ~StepTable();

  /// Throws std::runtime_error with the folder and the reason if the file cannot be written.
  void push_back(const RunStep&);
  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  RunStep operator[](size_t k) const;
  RunStep back() const { return (*this)[size_ - 1]; }

 private:
  friend class StepReader;
  size_t row_doubles() const { return static_cast<size_t>(5 + 2 * nq_ + 4 * nv_); }
  void swap(StepTable& other) noexcept;
  void write_block();
  const double* block(size_t index, std::vector<double>& buffer) const;

  size_t bytes_in_memory_ = 32 << 20;
  Eigen::Index nq_ = 0, nv_ = 0;
  size_t size_ = 0, rows_per_block_ = 0;
  std::vector<std::vector<double>> in_memory_;  ///< whole blocks; those after them are in the file
  std::vector<double> last_;                    ///< the block that is being filled
  int fd_ = -1;
};

/// Reads rows of a table in any order; neighbours are cheap.
class StepReader {
 public:
  explicit StepReader(const StepTable& table) : table_(table) {}
  /// Valid until the next call. The table must not have grown since the reader was made.
  const RunStep& at(size_t k);

 private:
  const StepTable& table_;
  const double* block_ = nullptr;
  size_t block_index_ = 0;
  std::vector<double> buffer_;  ///< of a block that is not in memory
  RunStep row_;
};

}  // namespace lab
