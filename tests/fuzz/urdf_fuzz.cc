// Whatever bytes a URDF file holds: it is refused with a message, or gives a model with which inverse and forward
// dynamics compute finite numbers (or refuse by an exception). Never a crash, a hang, or a silent NaN.
//
// Build and run:
//   scripts/lab build --preset fuzz --target urdf_fuzz --target urdf_corpus_write
//   build/fuzz/bin/urdf_corpus_write tests/core/urdf/corpus.txt build/fuzz/urdf_seeds
//   build/fuzz/bin/urdf_fuzz -dict=tests/fuzz/urdf.dict -timeout=10 -max_total_time=300 build/fuzz/urdf_seeds
#include <rbd/urdf/urdf.h>

#include <cstdint>
#include <cstdlib>
#include <iostream>

#include "tests/core/urdf/corpus.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  rbd::urdf::Options options;
  options.meshes = false;  // the disk is not part of it
  options.floating_base = size % 2;
  options.mimic = size % 4 < 2;
  const std::string text(reinterpret_cast<const char*>(bytes), size);
  const rbd::urdf::Loaded loaded = rbd::urdf::loadXML(text, options);
  if (!loaded.ok()) return 0;
  if (const std::string wrong = rbd::urdf::evaluate(loaded.model); !wrong.empty()) {
    std::cerr << "accepted, but " << wrong << "\n";
    std::abort();
  }
  return 0;
}
