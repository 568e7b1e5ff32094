// The charts of a page about runs, in groups that share a heading and a legend.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lab/evaluation/energy.h"
#include "lab/evaluation/tool.h"
#include "lab/evaluation/tracking.h"
#include "lab/page/template.h"
#include "lab/plot/chart.h"
#include "lab/report/folder.h"

namespace lab::report {

/// A chart and its heading.
struct Panel {
  std::string caption, unit;
  plot::Chart chart;
};

struct ChartGroup {
  std::vector<Panel> panels;
  std::vector<plot::Curve> legend;  ///< labels and inks; the data does not matter
  int columns = 3;                  ///< 1, 2 or 3 in a row, where there is room
};

ChartGroup tracking_charts(const Run&);
ChartGroup error_charts(const Run&);
ChartGroup effort_charts(const Run&);
ChartGroup energy_charts(const Run&);  ///< empty if steps are missing in the log
ChartGroup tool_charts(const Run&);    ///< empty if the robot has no link
ChartGroup loop_charts(const std::vector<Loops>&);

/// Drawn, for the template charts.html; null for an empty group.
nlohmann::json drawn(const ChartGroup&);

/// The room's templates.
const page::Texts& embedded();

/// s: t_k.
double time_of(const RunStep&, const Run&);
/// "rad" or "m": of the position and error of a joint by its place in v.
std::string position_unit(const rbd::Model&, int iv);

/// Gives the i-th of several curves an ink of its own; from the eighth on they are dashed. None is grey, the colour of all
/// that has no name.
void ink(plot::Curve&, size_t i);
/// Buckets for plot::Thinned, such that a page of so many curves stays small.
size_t buckets_for(size_t curves);

/// us: quantile of the loop times, share in 0..1, rounded up to the end of its bin.
int64_t loop_quantile(const Loops&, double share);

}  // namespace lab::report
