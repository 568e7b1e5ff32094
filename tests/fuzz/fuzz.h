#pragma once
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

/// What a fuzz program consists of: one function that libFuzzer (preset fuzz) calls with whatever bytes it thinks of, and
/// good inputs to begin with. tests/fuzz/smoke.cc drives the same function in the usual builds, with changed seeds.
extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size);

namespace lab::fuzz {

std::vector<std::vector<uint8_t>> seeds();

/// Ends the program with a word, for libFuzzer and for ctest alike.
inline void demand(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: %s\n", what);
  std::abort();
}

}  // namespace lab::fuzz
