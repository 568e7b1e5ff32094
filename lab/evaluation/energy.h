#pragma once
#include <vector>

#include "lab/evaluation/evaluate.h"

/// Energy against work.
namespace lab {

struct Energy {
  std::vector<double> energy,
      work;                     ///< J by step: kinetic and potential; done since step 0. Empty when thinned
  double drift = 0, scale = 0;  ///< J: largest |gained - work|; largest kinetic energy. NaN when thinned
};

/// tau is constant over a step, so that its work is exactly tau times the way; what friction takes is summed by
/// the trapezoidal rule. Needs every step.
Energy balance(const Run&);

}  // namespace lab
