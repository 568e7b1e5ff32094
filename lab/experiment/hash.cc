#include "lab/experiment/hash.h"

#include <xxhash.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <vector>

namespace lab {

int64_t hash_of(std::string_view text) { return static_cast<int64_t>(XXH3_64bits(text.data(), text.size())); }

int64_t hash_of_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return 0;
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
  XXH3_64bits_reset(state.get());
  std::vector<char> block(1 << 20);
  do {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    XXH3_64bits_update(state.get(), block.data(), static_cast<size_t>(in.gcount()));
  } while (in);
  return static_cast<int64_t>(XXH3_64bits_digest(state.get()));
}

std::string hex(int64_t hash) {
  char text[20];
  snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(hash));
  return text;
}

}  // namespace lab
