// A message of a step, empty but for its head.
#pragma once
#include <cstdint>

namespace lab {

template <class T>
T message_of(int64_t run, int64_t step) {
  T m{};
  m.run = run;
  m.step = step;
  return m;
}

}  // namespace lab
