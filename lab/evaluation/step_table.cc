#include "lab/evaluation/step_table.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

namespace lab {
namespace {

constexpr size_t kBlockBytes = 1 << 20;

std::string folder_for_steps() {
  const char* named = std::getenv("TMPDIR");
  return named && *named ? named : "/var/tmp";
}

[[noreturn]] void fail(const char* what) {
  const std::string why = std::strerror(errno);
  throw std::runtime_error(
      fmt::format("{}: {} for the steps of a long run ({}); TMPDIR can name another folder",
                  folder_for_steps(), what, why));
}

int open_without_name() {
  std::string path = folder_for_steps() + "/lab-steps-XXXXXX";
  const int fd = ::mkostemp(path.data(), O_CLOEXEC);
  if (fd < 0) fail("no file can be made");
  ::unlink(path.c_str());
  return fd;
}

double* put(double* at, const Eigen::VectorXd& values) {
  return std::copy(values.data(), values.data() + values.size(), at);
}
double* put(double* at, double value) {
  *at = value;
  return at + 1;
}
/// Steps are kept bit by bit: a double has only 53 bits for a whole number.
double* put(double* at, int64_t value) { return put(at, std::bit_cast<double>(value)); }

const double* take(const double* at, Eigen::VectorXd& values, Eigen::Index size) {
  values = Eigen::VectorXd::Map(at, size);
  return at + size;
}

}  // namespace

StepTable::StepTable(const StepTable& other) : bytes_in_memory_(other.bytes_in_memory_) {
  StepReader steps(other);
  for (size_t k = 0; k < other.size_; ++k) push_back(steps.at(k));
}

StepTable::StepTable(StepTable&& other) noexcept { swap(other); }

StepTable& StepTable::operator=(StepTable other) noexcept {
  swap(other);
  return *this;
}

void StepTable::swap(StepTable& other) noexcept {
  std::swap(bytes_in_memory_, other.bytes_in_memory_);
  std::swap(nq_, other.nq_);
  std::swap(nv_, other.nv_);
  std::swap(size_, other.size_);
  std::swap(rows_per_block_, other.rows_per_block_);
  std::swap(in_memory_, other.in_memory_);
  std::swap(last_, other.last_);
  std::swap(fd_, other.fd_);
}

StepTable::~StepTable() {
  if (fd_ >= 0) ::close(fd_);
}

void StepTable::push_back(const RunStep& step) {
  if (size_ == 0) {
    nq_ = step.state.q.size();
    nv_ = step.state.v.size();
    rows_per_block_ = std::max<size_t>(1, kBlockBytes / sizeof(double) / row_doubles());
  }
  const RobotState& s = step.state;
  const Reference& r = step.reference;
  if (s.q.size() != nq_ || r.q.size() != nq_ || s.v.size() != nv_ || s.tau.size() != nv_ ||
      r.v.size() != nv_ || r.a.size() != nv_)
    throw std::logic_error("StepTable: a step's vectors do not have the sizes of the first step's");
  const size_t before = last_.size();
  last_.resize(before + row_doubles());
  double* at = put(put(put(put(put(last_.data() + before, s.step), s.time), s.q), s.v), s.tau);
  at = put(put(put(put(at, r.step), r.q), r.v), r.a);
  put(put(at, step.stored_energy), step.external_work);
  if (++size_ % rows_per_block_ == 0) write_block();
}

/// The last block is full.
void StepTable::write_block() {
  const size_t bytes = last_.size() * sizeof(double);
  if (fd_ < 0 && (in_memory_.size() + 1) * bytes <= bytes_in_memory_) {
    in_memory_.push_back(std::exchange(last_, {}));
    return;
  }
  if (fd_ < 0) fd_ = open_without_name();
  const auto* data = reinterpret_cast<const char*>(last_.data());
  for (size_t done = 0; done < bytes;) {
    const ssize_t n = ::write(fd_, data + done, bytes - done);
    if (n < 0 && errno != EINTR) fail("there is no room");
    done += static_cast<size_t>(std::max<ssize_t>(n, 0));
  }
  last_.clear();
}

const double* StepTable::block(size_t index, std::vector<double>& buffer) const {
  if (index < in_memory_.size()) return in_memory_[index].data();
  if (index == size_ / rows_per_block_) return last_.data();
  buffer.resize(rows_per_block_ * row_doubles());
  const size_t bytes = buffer.size() * sizeof(double);
  auto* data = reinterpret_cast<char*>(buffer.data());
  const size_t offset = (index - in_memory_.size()) * bytes;
  for (size_t done = 0; done < bytes;) {
    const ssize_t n = ::pread(fd_, data + done, bytes - done, static_cast<off_t>(offset + done));
    if (n == 0) throw std::logic_error("StepTable: a row is not in its file");
    if (n < 0 && errno != EINTR) fail("what was written cannot be read");
    done += static_cast<size_t>(std::max<ssize_t>(n, 0));
  }
  return buffer.data();
}

RunStep StepTable::operator[](size_t k) const { return StepReader(*this).at(k); }

const RunStep& StepReader::at(size_t k) {
  const size_t index = k / table_.rows_per_block_;
  if (!block_ || index != block_index_) block_ = table_.block(index, buffer_);
  block_index_ = index;
  const double* at = block_ + k % table_.rows_per_block_ * table_.row_doubles();
  const Eigen::Index nq = table_.nq_, nv = table_.nv_;
  row_.state.step = std::bit_cast<int64_t>(*at++);
  row_.state.time = *at++;
  at = take(take(take(at, row_.state.q, nq), row_.state.v, nv), row_.state.tau, nv);
  row_.reference.step = std::bit_cast<int64_t>(*at++);
  at = take(take(take(at, row_.reference.q, nq), row_.reference.v, nv), row_.reference.a, nv);
  row_.stored_energy = *at++;
  row_.external_work = *at;
  return row_;
}

}  // namespace lab
