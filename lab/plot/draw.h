// Charts and heat maps as SVG that stands inside a page: colours and fonts are classes of the page's style, so that it
// follows dark screens and print. The same values give the same bytes.
#pragma once
#include <string>
#include <vector>

#include "lab/plot/chart.h"

namespace lab::plot {

/// One <svg>.
std::string draw(const Chart&);

/// The line of a legend that shows this curve's ink: a small <svg>.
std::string draw_key(const Curve&);

/// A value for every pair of two keys, as colours.
struct HeatMap {
  struct Cell {
    double value = 0;     ///< NaN: a cross instead
    bool marked = false;  ///< a small cross in the corner
    std::string tooltip;
  };
  std::string title;  ///< for screen readers
  std::string x_name, y_name, value_name;
  std::vector<std::string> columns, rows;  ///< their labels
  std::vector<Cell> cells;                 ///< row by row, the first row at the bottom
};

/// px: how wide the map of so many columns is, with numbers in its cells unless these are too many.
int map_width(size_t columns);

/// The colour scale is logarithmic when the range suits it.
std::string draw(const HeatMap&);

}  // namespace lab::plot
