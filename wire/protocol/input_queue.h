// INPUT messages by number, until the step that applies them.
#pragma once
#include <map>
#include <span>
#include <vector>

#include "lab/signals/signals.h"
#include "wire/protocol/role.h"

namespace lab {

class InputQueue {
 public:
  static constexpr size_t kMaxWaiting = 32'768;  ///< further ones are dropped, and asked for again

  /// Adds an INPUT; one that was applied or is here already is ignored.
  void add(std::span<const uint8_t> input);
  /// True when every INPUT up to this number has been applied or is here.
  bool complete_to(int64_t seq) const;
  /// Takes the INPUTs up to this number, in order; those that are not here are left out for good.
  std::vector<Action> take_to(int64_t seq);

 private:
  std::map<int64_t, Bytes> waiting_;  ///< by number
  int64_t applied_ = 0;               ///< number of the last one taken
};

}  // namespace lab
