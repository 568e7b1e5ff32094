#pragma once
#include <string>

#include "lab/experiment/experiment.h"

namespace lab::test {

/// What `call` says when it refuses an experiment; "accepted" when it does not.
template <class Call>
std::string refusal_of(Call&& call) {
  try {
    call();
  } catch (const ExperimentError& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace lab::test
