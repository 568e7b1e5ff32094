// Evaluates a run from its logged steps alone: metrics.json.
#pragma once
#include <rbd/model/model.h>

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lab/evaluation/metrics.h"
#include "lab/evaluation/step_table.h"
#include "lab/experiment/experiment.h"

namespace lab {

struct Run {
  rbd::Model model;                   ///< as simulated
  double dt = 0;                      ///< s
  Eigen::VectorXd damping, friction;  ///< nv, of the simulator
  StepTable steps;                    ///< that were logged, step 0 first
  int64_t last_step = 0;              ///< that the experiment asks for
  bool aborted = false;
  bool until_ended = false;  ///< no step was to be the last
  std::string reason;        ///< of the abort
  double band = 0.01;        ///< rad, m: within this error a joint counts as settled
  std::string tool;          ///< frame whose errors are judged; empty = the last link
};

/// A run of the experiment that has no step yet.
Run begin_run(const Experiment&, const rbd::Model&);

/// All metrics; "joints": the same per joint; "reaches": one by one; "verdicts" of `expect`, and "passed": every
/// verdict holds and the run reached its last step. A metric that has no value is null (and fails its verdict);
/// nothing is ever NaN. Errors are difference(q, q_ref) of the joints with one degree of freedom.
nlohmann::json evaluate(const Run&, const std::map<std::string, Bound>& expect);

}  // namespace lab
