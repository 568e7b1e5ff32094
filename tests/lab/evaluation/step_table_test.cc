// Rows come back bit by bit, from memory and from the file.
#include "lab/evaluation/step_table.h"

#include <gtest/gtest.h>
#include <stdlib.h>

#include <bit>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

namespace lab {
namespace {

constexpr int kNq = 7, kNv = 6;
constexpr size_t kRowBytes = sizeof(double) * (5 + 2 * kNq + 4 * kNv);

/// All its numbers differ, and from those of other steps.
RunStep step_of(size_t k) {
  double next = static_cast<double>(k) * 100;
  const auto vector = [&](int n) {
    Eigen::VectorXd out(n);
    for (int i = 0; i < n; ++i) out[i] = ++next;
    return out;
  };
  RunStep out;
  out.state.step = out.reference.step = (int64_t{1} << 62) + static_cast<int64_t>(k);
  out.state.time = ++next;
  out.state.q = vector(kNq), out.state.v = vector(kNv), out.state.tau = vector(kNv);
  out.reference.q = vector(kNq), out.reference.v = vector(kNv), out.reference.a = vector(kNv);
  out.stored_energy = ++next, out.external_work = k % 2 == 0 ? -0.0 : ++next;
  return out;
}

void expect_same(const RunStep& a, const RunStep& b) {
  EXPECT_EQ(a.state.step, b.state.step);
  EXPECT_EQ(a.state.time, b.state.time);
  EXPECT_EQ(a.state.q, b.state.q);
  EXPECT_EQ(a.state.v, b.state.v);
  EXPECT_EQ(a.state.tau, b.state.tau);
  EXPECT_EQ(a.reference.step, b.reference.step);
  EXPECT_EQ(a.reference.q, b.reference.q);
  EXPECT_EQ(a.reference.v, b.reference.v);
  EXPECT_EQ(a.reference.a, b.reference.a);
  EXPECT_EQ(a.stored_energy, b.stored_energy);
  EXPECT_EQ(std::bit_cast<int64_t>(a.external_work), std::bit_cast<int64_t>(b.external_work));
}

TEST(StepTable, RowsComeBackFromMemoryAndFromTheFile) {
  const size_t n = 5 * (size_t{1} << 20) / kRowBytes;  // of five blocks, two fit
  StepTable table(size_t{2} << 20);
  EXPECT_TRUE(table.empty());
  for (size_t k = 0; k < n; ++k) {
    table.push_back(step_of(k));
    ASSERT_EQ(table.size(), k + 1);
    if (k % 1000 == 0) expect_same(table.back(), step_of(k));
  }
  StepTable moved = std::move(table);
  const StepTable copy = moved;
  expect_same(copy[n / 2], step_of(n / 2));
  expect_same(copy.back(), step_of(n - 1));
  StepReader forward(moved), backward(moved);
  for (size_t k = 0; k < n; ++k) {
    expect_same(forward.at(k), step_of(k));
    expect_same(backward.at(n - 1 - k), step_of(n - 1 - k));
    if (HasFailure()) FAIL() << k;
  }
  expect_same(moved[0], step_of(0));
  moved = {};
  EXPECT_TRUE(moved.empty());
}

TEST(StepTable, AFolderThatCannotBeWrittenIsNamed) {
  const char* before = getenv("TMPDIR");
  const std::string kept = before ? before : "";
  setenv("TMPDIR", "/proc/nowhere", 1);
  StepTable table(0);
  std::string said;
  try {
    for (size_t k = 0; k < (size_t{2} << 20) / kRowBytes; ++k) table.push_back(step_of(k));
  } catch (const std::runtime_error& error) {
    said = error.what();
  }
  before ? setenv("TMPDIR", kept.c_str(), 1) : unsetenv("TMPDIR");
  EXPECT_EQ(
      said,
      "/proc/nowhere: no file can be made for the steps of a long run (No such file or directory); TMPDIR "
      "can name another folder");
}

}  // namespace
}  // namespace lab
