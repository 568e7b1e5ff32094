#pragma once
#include <signal.h>
#include <unistd.h>

#include <atomic>

namespace lab {

/// The signal that asked this process to end; 0 = none yet. Everybody who waits or works looks at it.
inline std::atomic<int> interrupted = 0;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler writes it");

/// INT and TERM are noted in `interrupted`; the second one ends the process at once.
inline void heed_signals() {
  struct sigaction action{};
  action.sa_handler = [](int number) {
    if (interrupted) _exit(128 + number);
    interrupted = number;
  };  // no SA_RESTART: a wait in the bus ends early
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace lab
