#pragma once
#include "procs/planner/motions.h"

/// A spline through planner.targets, from rest at q0 to rest at the last one, without a rest between.
namespace lab::planner {

void prepare_waypoints(const Experiment&, const rbd::Model&, Config&);
void waypoints(const Config&, double t, Reference&);
/// When the first target from time t on is reached.
double next_waypoint(const Config&, double t);

}  // namespace lab::planner
