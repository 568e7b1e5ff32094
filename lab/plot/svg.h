// The elements of SVG that plots are made of. Coordinates are rounded to a tenth of a pixel.
#pragma once
#include <fmt/format.h>

#include <string>

#include "lab/page/template.h"

namespace lab::plot::svg {

inline std::string open(int width, double height, const std::string& title) {
  return fmt::format("<svg viewBox=\"0 0 {} {:.0f}\" role=\"img\" aria-label=\"{}\">\n", width, height,
                     page::escape(title));
}

/// The end of an element, with a tooltip unless that is empty.
inline std::string close(const char* tag, const std::string& tooltip) {
  return tooltip.empty() ? "/>\n" : "><title>" + page::escape(tooltip) + "</title></" + tag + ">\n";
}

/// anchor: "start", "middle" or "end".
inline std::string text(double x, double y, const std::string& words, const char* anchor = "middle",
                        const std::string& attributes = "") {
  return fmt::format("<text class=\"t\" x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\"{}>{}</text>\n", x, y,
                     anchor, attributes, page::escape(words));
}

inline std::string upright_text(double x, double y, const std::string& words) {
  return text(x, y, words, "middle", fmt::format(" transform=\"rotate(-90 {:.1f} {:.1f})\"", x, y));
}

/// kind: a class of the page's style.
inline std::string line(double x1, double y1, double x2, double y2, const char* kind) {
  return fmt::format("<path class=\"{}\" d=\"M{:.1f},{:.1f} {:.1f},{:.1f}\"/>\n", kind, x1, y1, x2, y2);
}

inline std::string rect(double x, double y, double width, double height, const std::string& attributes,
                        const std::string& tooltip = "") {
  return fmt::format("<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" {}", x, y, width,
                     height, attributes) +
         close("rect", tooltip);
}

/// ink: the name of a colour of the page's style.
inline std::string dot(double x, double y, double radius, const char* ink, const std::string& tooltip) {
  return fmt::format("<circle class=\"dot f-{}\" cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\"", ink, x, y, radius) +
         close("circle", tooltip);
}

inline std::string cross(double x, double y, const std::string& tooltip) {
  return fmt::format("<path class=\"cross\" d=\"M{:.1f} {:.1f}l8 8m0 -8l-8 8\"", x - 4, y - 4) +
         close("path", tooltip);
}

}  // namespace lab::plot::svg
