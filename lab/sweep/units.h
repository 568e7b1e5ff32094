// Units of what stands on a sweep's page: of the keys that vary, and of the metrics.
#pragma once
#include <rbd/model/model.h>

#include <string>

#include "lab/experiment/experiment.h"
#include "lab/sweep/sweep.h"

namespace lab::sweep {

/// Those of the first run's robot and control law.
class Units {
 public:
  explicit Units(const Sweep&);

  /// "controller.kp (Nm/rad)": a key or a metric with its unit, if it has one.
  std::string with_unit(const std::string& name) const;
  std::string of_key(const std::string& key) const;
  std::string of_metric(const std::string& metric) const;

 private:
  Experiment experiment_;
  rbd::Model model_;  ///< without joints if the first run cannot be made
};

}  // namespace lab::sweep
