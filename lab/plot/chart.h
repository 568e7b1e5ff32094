// Charts as plain values: what is drawn, not how. lab/plot/draw.h makes SVG of them.
#pragma once
#include <string>
#include <utility>
#include <vector>

namespace lab::plot {

/// Colours that differ for colour-blind eyes too (Okabe and Ito 2008); the page's style has a shade of each for dark
/// screens.
enum class Ink { Blue, Orange, Red, Green, Purple, Sky, Brown, Grey };
/// How many series have inks of their own; grey is for what has no name.
inline constexpr size_t kSeriesInks = 7;
/// Of the i-th of several series, wherever it is drawn; they repeat.
Ink series_ink(size_t i);

struct Curve {
  std::string label;
  std::vector<double> x{}, y{};  ///< of the same length
  Ink ink = Ink::Blue;
  double width = 1.4;
  bool dashed = false;
};

/// One result: a dot, and a line from low to high if they differ. A y that is not a number is a cross at the top.
struct Mark {
  double x = 0, y = 0, low = 0, high = 0;
  std::string tooltip;
  Ink ink = Ink::Blue;
};

struct Tick {
  double value = 0;
  std::string label;
};

struct Chart {
  std::string title;  ///< for screen readers
  int width = 350, height = 170;
  std::string x_label = "time (s)";
  std::string y_label{};  ///< along the vertical axis; usually the caption above the chart has it
  std::vector<Curve> curves{};
  std::vector<Mark> marks{};
  std::vector<std::pair<Ink, std::string>>
      key{};  ///< what the inks of marks stand for, in a line above the area
  std::vector<double> must_include_x{}, must_include_y{};  ///< values that the axes always include
  std::vector<double> levels{};                    ///< horizontal dashed lines, drawn where they are in range
  std::vector<std::pair<double, double>> bands{};  ///< shaded between two heights
  std::vector<Tick> x_ticks{};                     ///< used if they fit, in place of round numbers
  bool categories = false;  ///< x_ticks are names without a scale: if they do not fit, every n-th is drawn
  bool equal = false;       ///< a length is the same on both axes
  bool logarithmic_x = false, logarithmic_y = false;
  bool bars = false;  ///< the first curve as bars from 0: x[i] to x[i + 1], y[i] high
};

/// The points of a curve that are kept.
class KeptPoints {
 public:
  /// When all have come.
  Curve curve(std::string label, Ink ink) const;

 protected:
  std::vector<double> x_, y_;
};

/// Makes a curve of `n` points while they come, and keeps at most 2 * buckets + 2 of them: minimum and maximum of each
/// bucket, in their order, so that peaks survive; first and last point stay.
class Thinned : public KeptPoints {
 public:
  Thinned(size_t n, size_t buckets) : n_(n), buckets_(buckets) {}

  void add(double x, double y);

 private:
  struct Point {
    size_t at = 0;
    double x = 0, y = 0;
  };
  void keep(const Point&);
  void close_bucket();

  size_t n_, buckets_;
  size_t added_ = 0, bucket_ = 0, bucket_end_ = 0;
  Point low_, high_;  ///< of the bucket
};

/// Keeps at most `points`, evenly taken, first and last included: for curves in space.
class ThinnedEvenly : public KeptPoints {
 public:
  ThinnedEvenly(size_t n, size_t points) : n_(n), points_(points) {}

  void add(double x, double y);

 private:
  size_t n_, points_, added_ = 0;
};

/// The smallest and largest x (or y) over all curves and marks, and of what the axis must include.
std::pair<double, double> x_range(const Chart&);
std::pair<double, double> y_range(const Chart&);

}  // namespace lab::plot
