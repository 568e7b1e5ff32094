// Evaluates the dynamics of a robot for states that come as JSON.
#pragma once
#include <rbd/model/model.h>

#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace lab::model {

/// What is wrong with the whole input, in one line: no state can be evaluated.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct Evaluation {
  nlohmann::ordered_json out;
  std::vector<std::string> errors;    ///< "state 2: ..": states that hold {"error": text} instead of numbers
  std::vector<std::string> warnings;  ///< keys that are not read
};

/// Every quantity of the dynamics for each state of `in`; docs/lab-model.md lists them. Only the header
/// (nq, nv, mass, joints) when `in` has no states. Throws InputError. No number of the result is NaN or
/// infinite.
Evaluation evaluate(const rbd::Model&, const nlohmann::json& in);

/// JSON from text. Throws InputError with line and column.
nlohmann::json parse(const std::string& text);

}  // namespace lab::model
