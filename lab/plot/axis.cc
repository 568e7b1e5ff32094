#include "lab/plot/axis.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "lab/page/page.h"

namespace lab::plot {
namespace {

/// With as many decimals as the step has, so that the labels of an axis line up.
std::string linear_label(double value, double step) {
  if (std::abs(value) >= 1e6 || step < 0.9e-5) return page::figure(value, 6);
  const int decimals = std::max(0, static_cast<int>(-std::floor(std::log10(step) + 1e-9)));
  std::string text = fmt::format("{:.{}f}", std::abs(value), decimals);
  if (value == 0) text = "0";
  return value < 0 ? "−" + text : text;
}

/// 10 with the power above it.
std::string power_of_ten(int power) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  if (power == 0) return "1";
  std::string text = power < 0 ? "10⁻" : "10";
  for (char digit : std::to_string(std::abs(power))) text += kDigits[digit - '0'];
  return text;
}

}  // namespace

Axis::Axis(std::pair<double, double> range, bool logarithmic, double pixel_from, double pixel_to)
    : low_(range.first), high_(range.second), from_(pixel_from), to_(pixel_to), logarithmic_(logarithmic) {}

double Axis::share(double value) const {
  if (!logarithmic_) return value / (high_ - low_) - low_ / (high_ - low_);  // no overflow at 1e308
  return value > 0 ? std::log(value / low_) / std::log(high_ / low_) : NAN;
}

std::vector<Tick> Axis::ticks(size_t most) const {
  return logarithmic_ ? logarithmic_ticks(most) : linear_ticks(most);
}

std::vector<Tick> Axis::linear_ticks(size_t most) const {
  // the smallest step of 1, 2 or 5 times a power of ten that gives no more than most + 1 ticks
  const double rough = high_ / static_cast<double>(most + 1) - low_ / static_cast<double>(most + 1);
  const double unit = std::pow(10, std::floor(std::log10(rough)));
  double step = unit;
  for (double factor : {1.0, 2.0, 5.0, 10.0, 20.0}) {
    step = factor * unit;
    if (std::floor(high_ / step) - std::ceil(low_ / step) <= static_cast<double>(most)) break;
  }
  std::vector<Tick> ticks;
  const double slack = 1e-9 * step;  // an end that is a round value has its tick
  for (double k = std::ceil((low_ - slack) / step); k * step <= high_ + slack; ++k)
    ticks.push_back({k * step, linear_label(k * step, step)});
  return ticks;
}

std::vector<Tick> Axis::logarithmic_ticks(size_t most) const {
  const int first = static_cast<int>(std::floor(std::log10(low_))),
            last = static_cast<int>(std::ceil(std::log10(high_)));
  std::vector<int> digits{1};
  if (last - first <= 3)
    digits = 3 * static_cast<size_t>(last - first) <= most ? std::vector{1, 2, 5} : std::vector{1, 3};
  const int step = std::max(1, (last - first + static_cast<int>(most)) / static_cast<int>(most + 1));
  const bool plain = first >= -3 && last <= 5;
  std::vector<Tick> ticks;
  for (int power = first; power <= last; power += step)
    for (int digit : digits) {
      const double value = digit * std::pow(10, power);
      if (value < low_ * (1 - 1e-9) || value > high_ * (1 + 1e-9)) continue;
      ticks.push_back({value, plain ? page::figure(value, 6)
                                    : (digit > 1 ? std::to_string(digit) + "·" : "") + power_of_ten(power)});
    }
  return ticks;
}

std::pair<double, double> padded(std::pair<double, double> range, double share) {
  const auto [low, high] = range;
  const double size = high - low, middle = low / 2 + high / 2;
  double room = share * size;
  if (size <= 1e-5 * std::abs(middle) || size < 1e-12)
    room = std::abs(middle) < 1e-12 ? 1 : 0.1 * std::abs(middle);
  if (!std::isfinite(room)) room = 0;
  return {low - room, high + room};
}

std::pair<double, double> padded_logarithmic(std::pair<double, double> range) {
  const double room = range.first == range.second ? 2 : std::pow(range.second / range.first, 0.04);
  return {range.first / room, range.second * room};
}

bool suits_logarithm(std::pair<double, double> range) {
  return range.first > 0 && range.second / range.first > 50;
}

}  // namespace lab::plot
