// The plots of a sweep's page: a metric over the keys that vary. Where several runs meet in one place, their mean.
#pragma once
#include <string>
#include <vector>

#include "lab/sweep/results.h"
#include "lab/sweep/sweep.h"
#include "lab/sweep/units.h"

namespace lab::sweep {

struct Plot {
  std::string svg;
  int width;  ///< px: in which its texts are as large as those of the page
};

/// For a metric a heat map over the first two keys of the grid, a line over a single one, and a cloud of points
/// over every drawn key, in which few points of a grid have colours of their own. Keys and values with their units.
std::vector<Plot> plots_of(const Sweep&, const std::vector<Row>&, const Units&, size_t metric);

}  // namespace lab::sweep
