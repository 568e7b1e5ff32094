// The liblcm back end of the bus.
#pragma once
#include <memory>

#include "wire/bus/bus.h"

namespace lab {

/// The liblcm back end, for every URL that liblcm knows. Throws BusError.
/// It receives its own messages and cannot see senders or losses.
std::unique_ptr<Bus> open_liblcm(const BusUrl& url, const BusOptions& options);

}  // namespace lab
