// What both back ends of the bus share: the fault hook and the rule for channel names.
#pragma once
#include <cstdint>
#include <string_view>

#include "wire/bus/bus.h"

namespace lab {

/// Throws std::invalid_argument unless it is 1..63 bytes without NUL.
void check_channel_name(std::string_view channel);

/// Env LAB_FAULT_DROP=percent[,seed]; throws BusError when it is set to something else.
FaultHook fault_from_env();

/// Decides for each packet whether to drop it: the same sequence for the same seed.
class FaultDice {
 public:
  explicit FaultDice(FaultHook hook) : state_(hook.seed), threshold_(hook.probability) {}
  bool active() const { return threshold_ > 0; }
  bool drop() { return active() && uniform() < threshold_; }

 private:
  // splitmix64
  double uniform() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return static_cast<double>((z ^ z >> 31) >> 11) * 0x1p-53;
  }
  uint64_t state_;
  double threshold_;
};

}  // namespace lab
