// A fuzz program without libFuzzer: seeds, and what becomes of them by many small changes, always the same ones.
//   X_smoke [ROUNDS]          runs them (default 20000)
//   X_smoke --write FOLDER    writes the seeds, for libFuzzer to begin with
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/fuzz/fuzz.h"

namespace {

using Bytes = std::vector<uint8_t>;

void change(Bytes& bytes, std::mt19937& random) {
  const auto below = [&](size_t n) { return n ? random() % n : 0; };
  constexpr uint8_t kOdd[] = {0, 1, 0x7f, 0x80, 0xff, 0xfe, '\n', '{'};
  switch (random() % 6) {
    case 0:
      if (!bytes.empty()) bytes[below(bytes.size())] ^= static_cast<uint8_t>(1u << random() % 8);
      break;
    case 1:
      if (!bytes.empty()) bytes[below(bytes.size())] = kOdd[random() % 8];
      break;
    case 2:
      bytes.resize(below(bytes.size() + 1));
      break;
    case 3:
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size() + 1)), random() % 9,
                   kOdd[random() % 8]);
      break;
    case 4:  // a number of four bytes, such as a count
      if (bytes.size() >= 4)
        for (size_t i = 0, at = below(bytes.size() - 3); i < 4; ++i) bytes[at + i] = kOdd[random() % 5];
      break;
    default:  // a piece again, somewhere else
      if (!bytes.empty()) {
        const size_t from = below(bytes.size()),
                     length = std::min<size_t>(1 + random() % 16, bytes.size() - from);
        const Bytes piece(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                          bytes.begin() + static_cast<std::ptrdiff_t>(from + length));
        bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size() + 1)), piece.begin(),
                     piece.end());
      }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Bytes> seeds = lab::fuzz::seeds();
  if (argc == 3 && argv[1] == std::string("--write")) {
    std::filesystem::create_directories(argv[2]);
    for (size_t i = 0; i < seeds.size(); ++i)
      std::ofstream(std::string(argv[2]) + "/seed" + std::to_string(i), std::ios::binary)
          .write(reinterpret_cast<const char*>(seeds[i].data()),
                 static_cast<std::streamsize>(seeds[i].size()));
    return 0;
  }
  std::mt19937 random(20261125);
  for (const Bytes& seed : seeds) LLVMFuzzerTestOneInput(seed.data(), seed.size());
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 20000;
  for (int round = 0; round < rounds; ++round) {
    Bytes bytes = seeds[random() % seeds.size()];
    for (unsigned i = 0, n = 1 + random() % 4; i < n; ++i) change(bytes, random);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
  }
}
