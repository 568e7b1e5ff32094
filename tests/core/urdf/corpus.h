// The table of malformed and odd URDF files (corpus.txt) and what each must be answered with.
#pragma once

#include <rbd/model/model.h>
#include <rbd/urdf/diagnostic.h>

#include <string>
#include <vector>

namespace rbd::urdf {

struct CorpusCase {
  std::string name;
  std::string wanted;  // as written: "error 4 joint 'j': axis is zero", or "ok": nothing to say
  std::string text;    // the whole file

  // `wanted` taken apart; of "ok" only that
  bool ok = false;
  Severity severity = Severity::Error;  // Error: refused; else accepted with this message
  int line = 0;
  std::string element;  // "" = the message names none
  std::string message;  // must be part of it
};

// Throws std::runtime_error with the line of a row that makes no sense.
std::vector<CorpusCase> read_corpus(const std::string& file);

// Runs inverse and forward dynamics at the neutral and at some random states. "" when every result is a
// finite number, or when forward dynamics refuses by an exception (a massless tip); else what came out wrong.
std::string evaluate(const Model& model);

}  // namespace rbd::urdf
