// A spline through planner.targets, from rest at q0 to rest at the last one, without stops in between.
#pragma once
#include "procs/planner/motions.h"

namespace lab::planner {

std::unique_ptr<Motion> make_waypoints(const Experiment&, const Config&);

}  // namespace lab::planner
