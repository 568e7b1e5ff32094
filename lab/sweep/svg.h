#pragma once
#include <string>
#include <vector>

/// The little of SVG that a sweep's page needs. Text in, text out; the same numbers give the same bytes.
namespace lab::sweep::svg {

/// From values to pixels; logarithmic when all values are above 0 and span more than a factor of 50.
class Scale {
 public:
  Scale(const std::vector<double>& values, double pixel_from, double pixel_to, bool room = true);
  double share(double value) const;  ///< 0 at the low end, 1 at the high end
  double at(double value) const { return from_ + share(value) * (to_ - from_); }
  std::vector<double> ticks() const;
  bool logarithmic() const { return log_; }
  double low() const { return low_; }
  double high() const { return high_; }

 private:
  double low_ = 0, high_ = 1, from_, to_;
  bool log_ = false;
};

/// Four digits are enough to look at.
std::string label(double value);
/// The same for a value that is a number; others as they are.
std::string label(const std::string& value);

/// Dark blue over green to yellow, share 0..1: "#2a788e". Readable in grey print too.
std::string colour(double share);
/// Black or white, whichever is readable on it.
const char* ink(double share);

std::string text(double x, double y, const std::string& words, const std::string& anchor = "middle",
                 const std::string& more = "");
/// kind: "frame" or "grid", as the page's style has them.
std::string line(double x1, double y1, double x2, double y2, const char* kind);
std::string rect(double x, double y, double width, double height, const std::string& fill,
                 const std::string& title = "");
std::string dot(double x, double y, double radius, const std::string& title = "");
/// A run that has no value there.
std::string cross(double x, double y, const std::string& title = "");

}  // namespace lab::sweep::svg
