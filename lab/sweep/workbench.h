// Makes experiments from a sweep and runs them.
#pragma once
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <unordered_map>

#include "lab/experiment/robot.h"
#include "lab/sweep/results.h"
#include "lab/sweep/sweep.h"

namespace lab::sweep {

/// Threads may share one.
class Workbench {
 public:
  explicit Workbench(const Sweep& sweep);

  /// Checks the metrics, and every value of the grid and the first draw once, before anything runs. Throws
  /// ExperimentError with the place in the sweep's file.
  void check();

  struct Job {
    Experiment experiment;
    std::shared_ptr<const Robot> robot;
    std::string key;  ///< of its result: a hash of everything that it depends on, the program included
  };
  /// Throws ExperimentError for values that no run can have.
  Job prepare(int64_t run) { return prepare(sweep_.overrides(run)); }

  /// What went wrong, on one line, with files by their last name: the same wherever the sweep is started.
  std::string reason(const std::exception&) const;

  /// The line of results that a run leaves; nothing if `keep_going` returns false. Throws what the steps throw.
  std::optional<std::string> work(const Job&, const std::function<bool()>& keep_going) const;

 private:
  Job prepare(const std::vector<Override>& overrides);
  std::shared_ptr<const Robot> robot_of(const Experiment&);

  const Sweep& sweep_;
  const int64_t program_;  ///< hash of this program: another one may compute something else
  std::mutex lock_;        ///< of the robots
  std::unordered_map<std::string, std::shared_ptr<const Robot>> robots_;
};

}  // namespace lab::sweep
