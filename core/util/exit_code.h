// The exit codes of all programs, as docs and scripts list them.
#pragma once

namespace lab {

enum ExitCode : int {
  kOk = 0,
  kCheckFailed = 1,  ///< a check failed, or a difference was found
  kUsage = 2,
  kBadConfig = 3,  ///< bad configuration or model
  kNotReady = 4,   ///< not ready in time
  kDied = 5,       ///< a required process died
  kSafety = 6,     ///< safety stop
  kTransport = 7,
  kAgain = 75  ///< the simulator asks its supervisor to start every process again (EX_TEMPFAIL of sysexits.h)
};

/// Whether a person ended it: HUP, INT or TERM.
constexpr bool was_stopped(int code) { return code == 129 || code == 130 || code == 143; }

}  // namespace lab
