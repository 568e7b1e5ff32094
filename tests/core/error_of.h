// What a call has to say when it refuses.
#pragma once

#include <exception>
#include <functional>
#include <string>

namespace rbd::testing {

// The message of the exception that `call` throws; "" when it throws none.
inline std::string errorOf(const std::function<void()>& call) {
  try {
    call();
  } catch (const std::exception& e) {
    return e.what();
  }
  return "";
}

}  // namespace rbd::testing
