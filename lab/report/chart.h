#pragma once
#include <string>
#include <utility>
#include <vector>

/// Line charts as plain values: what is drawn, not how. lab/report/gnuplot.h draws them.
namespace lab::report {

/// Colours that differ for colour-blind eyes too (Okabe and Ito 2008); the page has a shade of each for dark screens.
enum class Ink { Blue, Orange, Red, Green, Purple, Sky, Brown, Grey };
inline constexpr int kInks = 8;

struct Curve {
  std::string label;
  std::vector<double> x{}, y{};  ///< of the same length
  Ink ink = Ink::Blue;
  double width = 1.4;
  bool dashed = false;
};

struct Chart {
  std::string title;  ///< for readers that cannot see it
  int width = 350, height = 170;
  std::string x_label = "time (s)";
  std::vector<Curve> curves{};
  std::vector<double> in_sight_x{}, in_sight_y{};  ///< that the axes reach, whatever the curves do
  std::vector<double> levels{};                    ///< dashed lines across, drawn where they are in sight
  std::vector<std::pair<double, double>> bands{};  ///< shaded between two heights
  bool equal = false;                              ///< a length is the same on both axes
  bool logarithmic = false;                        ///< the upright axis
  bool bars = false;  ///< the first curve as bars: x[i] to x[i + 1], y[i] high; x logarithmic
};

/// At most 2 * buckets + 2 points: the least and the greatest of each bucket, in their order, so that peaks survive; first and last stay.
void thin(Curve&, size_t buckets);
/// Every n-th point and the last, at most `points`: for curves in space.
void thin_evenly(Curve&, size_t points);

/// The least and greatest of x (or y) over all curves, and of what must be in sight.
std::pair<double, double> x_range(const Chart&);
std::pair<double, double> y_range(const Chart&);

/// A unit that suits numbers up to `most`: factor 1000 and "mrad" for 0.01 rad.
struct Scale {
  double factor;
  std::string unit;
};
Scale scale_for(double most, const std::string& unit);
void rescale(Chart&, double factor);

}  // namespace lab::report
