// Keys that a person gave and nothing reads.
#pragma once
#include <set>
#include <string>

#include "lab/experiment/experiment.h"

namespace lab {

/// How the experiment.yaml of a run's folder begins, in every version: the lab wrote it, with every key.
inline constexpr const char* kAsRun = "# As run";

/// Throws ExperimentError for a key that the chosen motion or control law does not read, with a value other than the
/// default: `stiffness` for a pd would change nothing. Not judged are keys that the lab wrote into a run's folder, those of a
/// file whose kind was overridden, those of a process of the user's, and the sections (planner, controller) whose kind
/// `varies`, as in a sweep over it.
void check_unused(const Experiment&, const std::set<std::string>& varies = {});

}  // namespace lab
