#include <algorithm>
#include <array>
#include <cmath>

#include "lab/page/page.h"
#include "lab/plot/axis.h"
#include "lab/plot/draw.h"
#include "lab/plot/svg.h"

namespace lab::plot {
namespace {

constexpr double kCellsLeft = 84, kCellsTop = 8, kCellsRight = 14;  // px: margins of the cells
constexpr double kLeastWidth = 420;                                 // px: of all cells
/// px: a cell in which a number of three digits, such as −0.00123, is legible; maps of more than kMostNumbers columns would be
/// too wide for a page and have none: their cells are as narrow as they need to be.
constexpr double kNumberWidth = 48, kNumberHeight = 17;
constexpr size_t kMostNumbers = 24;

/// Of all cells.
double cells_width(size_t columns) {
  return columns <= kMostNumbers ? std::max(kLeastWidth, kNumberWidth * static_cast<double>(columns))
                                 : kNumberWidth * static_cast<double>(kMostNumbers);
}

/// Viridis (van der Walt and Smith 2015), share 0..1: dark blue over green to yellow, also readable in grey print.
std::string colour(double share) {
  constexpr std::array<std::array<int, 3>, 6> kStops{
      {{68, 1, 84}, {65, 68, 135}, {42, 120, 142}, {34, 168, 132}, {122, 209, 81}, {253, 231, 37}}};
  const double x = std::clamp(share, 0.0, 1.0) * (kStops.size() - 1);
  const size_t i = std::min<size_t>(static_cast<size_t>(x), kStops.size() - 2);
  std::array<int, 3> c{};
  for (size_t k = 0; k < 3; ++k)
    c[k] = static_cast<int>(
        std::lround(kStops[i][k] + (x - static_cast<double>(i)) * (kStops[i + 1][k] - kStops[i][k])));
  return fmt::format("#{:02x}{:02x}{:02x}", c[0], c[1], c[2]);
}

/// Black or white, whichever is readable on the colour.
const char* ink(double share) { return share > 0.6 ? "#000" : "#fff"; }

Axis shades(const HeatMap& map) {
  double low = INFINITY, high = -INFINITY;
  for (const HeatMap::Cell& cell : map.cells) {
    if (!std::isfinite(cell.value)) continue;
    low = std::min(low, cell.value);
    high = std::max(high, cell.value);
  }
  if (low > high) return Axis({0, 1}, false, 0, 1);
  if (low == high) return Axis(padded({low, high}), false, 0, 1);
  return Axis({low, high}, suits_logarithm({low, high}), 0, 1);
}

std::string draw_cell(const HeatMap::Cell& cell, const Axis& shade, double x, double y, double w, double h) {
  if (!std::isfinite(cell.value))
    return svg::rect(x, y, w, h, "class=\"empty\"", cell.tooltip) +
           svg::cross(x + w / 2, y + h / 2, cell.tooltip);
  const double share = shade.share(cell.value);
  std::string out = svg::rect(x, y, w, h, "fill=\"" + colour(share) + "\"", cell.tooltip);
  if (cell.marked && w > 24 && h >= kNumberHeight) out += svg::cross(x + w - 8, y + 8, cell.tooltip);
  if (w >= kNumberWidth && h >= kNumberHeight)
    out += svg::text(x + w / 2, y + h / 2 + 4, page::figure(cell.value, 3), "middle",
                     fmt::format(" style=\"fill:{}\" pointer-events=\"none\"", ink(share)));
  return out;
}

/// What the colours mean, below the map.
std::string colour_key(const HeatMap& map, const Axis& shade, double width, double top) {
  constexpr int kSteps = 48;
  std::string out;
  for (int i = 0; i < kSteps; ++i)
    out += svg::rect(kCellsLeft + width * i / kSteps, top, width / kSteps + 0.5, 10,
                     "fill=\"" + colour((i + 0.5) / kSteps) + "\"");
  out += svg::text(kCellsLeft, top + 24, page::figure(shade.low()), "start");
  out += svg::text(kCellsLeft + width, top + 24, page::figure(shade.high()), "end");
  return out +
         svg::text(kCellsLeft + width / 2, top + 24, map.value_name + (shade.logarithmic() ? " (log)" : ""));
}

}  // namespace

int map_width(size_t columns) { return static_cast<int>(kCellsLeft + cells_width(columns) + kCellsRight); }

std::string draw(const HeatMap& map) {
  const size_t rows = map.rows.size(), columns = map.columns.size();
  const Axis shade = shades(map);
  const double width = cells_width(columns), w = width / static_cast<double>(columns);
  const double least_height = rows <= kMostNumbers ? kNumberHeight : 4;
  const double h = std::clamp(280 / static_cast<double>(rows), least_height, 38.0);
  const double bottom = kCellsTop + h * static_cast<double>(rows);
  std::string out = svg::open(map_width(columns), bottom + 78, map.title);
  const size_t every_row = 1 + static_cast<size_t>(13 / h), every_column = 1 + static_cast<size_t>(44 / w);
  for (size_t r = 0; r < rows; ++r) {
    const double y = bottom - h * static_cast<double>(r + 1);  // the first value at the bottom, as in a plot
    if (r % every_row == 0) out += svg::text(kCellsLeft - 7, y + h / 2 + 4, map.rows[r], "end");
    for (size_t c = 0; c < columns; ++c)
      out += draw_cell(map.cells[r * columns + c], shade, kCellsLeft + w * static_cast<double>(c), y, w, h);
  }
  for (size_t c = 0; c < columns; c += every_column)
    out += svg::text(kCellsLeft + w * (static_cast<double>(c) + 0.5), bottom + 16, map.columns[c]);
  out += svg::text(kCellsLeft + width / 2, bottom + 32, map.x_name);
  out += svg::upright_text(14, kCellsTop + (bottom - kCellsTop) / 2, map.y_name);
  return out + colour_key(map, shade, width, bottom + 46) + "</svg>\n";
}

}  // namespace lab::plot
