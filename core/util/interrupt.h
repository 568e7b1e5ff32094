// Graceful end on SIGINT and SIGTERM: the handlers only set a flag that every loop looks at.
#pragma once
#include <signal.h>
#include <unistd.h>

#include <atomic>

namespace lab {

/// The signal that asked this process to end; 0 = none yet.
inline std::atomic<int> interrupted = 0;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler writes it");

/// INT and TERM are noted in `interrupted`; the second one ends the process at once.
inline void install_signal_handlers() {
  struct sigaction action{};
  action.sa_handler = [](int number) {
    if (interrupted) _exit(128 + number);
    interrupted = number;
  };  // no SA_RESTART: a wait in the bus ends early
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

}  // namespace lab
