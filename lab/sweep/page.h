// sweep.html: all runs of a sweep on one page that needs nothing else.
#pragma once
#include <string>
#include <vector>

#include "lab/sweep/results.h"
#include "lab/sweep/sweep.h"

namespace lab::sweep {

/// Plots of every metric (plots.h), the best runs, and those that went wrong. The same rows give the same bytes.
std::string page(const Sweep&, const std::vector<Row>&);

}  // namespace lab::sweep
