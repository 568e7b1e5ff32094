#pragma once
#include <string>
#include <vector>

#include "lab/evaluation/energy.h"
#include "lab/evaluation/tool.h"
#include "lab/evaluation/tracking.h"
#include "lab/report/chart.h"
#include "lab/report/folder.h"

/// The charts of a page, and how they stand in it.
namespace lab::report {

/// A chart and what stands above it.
struct Figure {
  std::string caption, unit;
  Chart chart;
};

/// Figures under one heading; one legend for all of them.
struct Gallery {
  std::vector<Figure> figures;
  std::vector<Curve> legend;  ///< labels and inks; the data does not matter
  int columns = 3;            ///< 1, 2 or 3 in a row, where there is room
};

Gallery tracking_gallery(const Run&);
Gallery error_gallery(const Run&);
Gallery effort_gallery(const Run&);
Gallery energy_gallery(const Run&);  ///< empty when the log is thinned
Gallery tool_gallery(const Run&);    ///< empty when there is no link
Gallery loop_gallery(const std::vector<Loops>&);

/// t_k of every logged step, s.
std::vector<double> times(const Run&);
/// By joint of joints_of(model), by step: difference(q, q_ref).
std::vector<std::vector<double>> errors(const Run&);
/// "rad" or "m": of a joint by its place in v.
std::string unit_of(const rbd::Model&, int iv);

/// The ink of the i-th of several curves; the second time round they are dashed.
void ink(Curve&, size_t i);
/// Points per curve that keep a page of so many curves small.
size_t buckets_for(size_t curves);

/// Draws all galleries with one call of gnuplot: the HTML of each, a line that says so where there is none.
struct Shown {
  std::vector<std::string> html;
  bool drawn = true;  ///< false: there is no gnuplot
};
Shown show(const std::vector<Gallery>&);

/// us that this share (0..1) of the loops did not exceed, to the end of its bin.
int64_t loop_quantile(const Loops&, double share);

}  // namespace lab::report
