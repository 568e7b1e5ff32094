// Paths of a frame in the world: a straight line, a circle. The joints are found before the motion begins: by inverse
// kinematics at knots along the path, each as near to q0 as the path allows (the null-space motion of a redundant arm
// must not drift), with a spline through them that keeps the frame within kPathTolerance of the path. During the motion
// the spline is evaluated at the quintic's progress: q, v and a depend on time alone, and v and a are exact derivatives.
#pragma once
#include "procs/planner/motions.h"

namespace lab::planner {

inline constexpr double kPathTolerance = 1e-5;  // m between the frame and its path
inline constexpr double kTurnTolerance = 2e-5;  // rad between the frame and its constant orientation

std::unique_ptr<Motion> make_line(const Experiment&, const Config&);
std::unique_ptr<Motion> make_circle(const Experiment&, const Config&);

}  // namespace lab::planner
