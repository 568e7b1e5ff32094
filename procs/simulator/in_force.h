// What requests have changed since a run began, and what they have not: the answer to `get`.
#pragma once
#include <rbd/model/model.h>

#include <map>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"
#include "lab/experiment/live_gains.h"
#include "lab/signals/signals.h"

namespace lab::simulator {

class InForce {
 public:
  /// `gains`: those that the control law reads; none for a controller of the user's, whose gains are not known.
  InForce(const Experiment&, const rbd::Model&, std::vector<std::string> gains);

  /// An action that takes effect.
  void take(const Action&);
  /// Lines "name<tab>value<tab>unit".
  std::string text() const;

 private:
  rbd::Model model_;
  std::string law_;
  std::vector<std::string> names_;
  LiveGains gains_;
  std::map<std::string, std::string> others_;  ///< name: value, unit
};

}  // namespace lab::simulator
