// Writes every case of the URDF corpus as DIR/NNN.urdf and prints what our reader does with it, one JSON line
// a case: {"file", "name", "wanted", "outcome": "refused|told|accepted|nan", "said"}. For urdf_corpus.py, and
// for the fuzzer's first inputs.
//
// usage: urdf_corpus CORPUS.txt DIR
#include <rbd/urdf/urdf.h>

#include <filesystem>
#include <fstream>
#include <iomanip>
#include <iostream>

#include "tests/core/urdf/corpus.h"

namespace {

std::string quoted(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
  }
  return out + "\"";
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: urdf_corpus CORPUS.txt DIR\n";
    return 2;
  }
  const std::filesystem::path folder = argv[2];
  std::filesystem::create_directories(folder);
  int number = 0;
  for (const rbd::urdf::CorpusCase& c : rbd::urdf::read_corpus(argv[1])) {
    std::ostringstream name;
    name << std::setw(3) << std::setfill('0') << ++number << ".urdf";
    std::ofstream(folder / name.str(), std::ios::binary) << c.text;

    const rbd::urdf::Loaded loaded = rbd::urdf::load((folder / name.str()).string());
    std::string said, outcome = loaded.ok() ? loaded.diagnostics.empty() ? "accepted" : "told" : "refused";
    for (const rbd::urdf::Diagnostic& d : loaded.diagnostics) {
      if (said.empty() || d.severity == rbd::urdf::Severity::Error) said = d.element + ": " + d.message;
    }
    if (loaded.ok()) {
      if (const std::string wrong = rbd::urdf::evaluate(loaded.model); !wrong.empty()) {
        outcome = "nan";
        said = wrong;
      }
    }
    std::cout << "{\"file\": " << quoted(name.str()) << ", \"name\": " << quoted(c.name)
              << ", \"wanted\": " << quoted(c.wanted) << ", \"outcome\": " << quoted(outcome)
              << ", \"said\": " << quoted(said) << "}\n";
  }
} catch (const std::exception& e) {
  std::cerr << "urdf_corpus: " << e.what() << "\n";
  return 1;
}
