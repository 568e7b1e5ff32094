#include <cinttypes>
#include <cstdio>

#include "tests/render/sample.h"

int main() {
  std::printf("%016" PRIx64 "\n",
              lab::render::hash_of(lab::render::draw_sample(lab::render::Quality::kFine)));
}
