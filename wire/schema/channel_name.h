// The bounds of a channel name, on the bus and in log files.
#pragma once
#include <cstddef>

namespace lab {

inline constexpr size_t kMaxChannelName = 63;  ///< bytes; LCM's own bound

}  // namespace lab
