#include <cinttypes>
#include <cstdio>
#include <exception>

#include "tests/render/sample.h"

int main() try {
  const auto picture = lab::render::draw_sample(lab::render::Quality::kFine);
  const lab::render::Renderer any(1, 1);
  std::printf("%016" PRIx64 " %s\n", lab::render::hash_of(picture), any.gl_info().c_str());
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
