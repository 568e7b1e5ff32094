#pragma once
#include <string>
#include <vector>

#include "lab/sweep/results.h"
#include "lab/sweep/sweep.h"

namespace lab::sweep {

/// sweep.html: one page that needs nothing else. For every metric a heat map over the first two keys of the grid, a line
/// over a single one, and a cloud of points over every drawn key; where several runs meet in one place, their mean. The
/// best runs, and those that went wrong. The same rows give the same bytes.
std::string page(const Sweep&, const std::vector<Row>&);

}  // namespace lab::sweep
