// Our own back end of the bus: LCM's UDPM wire format on one socket.
#pragma once
#include <memory>

#include "wire/bus/bus.h"

namespace lab {

/// Our own endpoint for udpm:// URLs: one thread, one receiving and one sending socket, LCM's UDPM wire
/// format. Throws BusError with what failed and what to do.
std::unique_ptr<Bus> open_udpm(const BusUrl& url, const BusOptions& options);

}  // namespace lab
