// The plots of a sweep's page: a metric over the keys that vary. Where several runs meet in one place, their mean.
#pragma once
#include <string>
#include <vector>

#include "lab/sweep/results.h"
#include "lab/sweep/sweep.h"

namespace lab::sweep {

/// As SVG: for a metric a heat map over the first two keys of the grid, a line over a single one, and a cloud of points
/// over every drawn key.
std::vector<std::string> plots_of(const Sweep&, const std::vector<Row>&, size_t metric);

}  // namespace lab::sweep
