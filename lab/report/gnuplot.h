#pragma once
#include <optional>
#include <string>
#include <vector>

#include "lab/report/chart.h"

/// Charts become SVG through one call of gnuplot (package gnuplot-nox).
namespace lab::report {

/// One <svg> per chart, to stand inside a page: no header, no names of programs, colours as classes of the page's
/// style. Nothing if there is no gnuplot. Throws std::runtime_error with what gnuplot complains about.
std::optional<std::vector<std::string>> draw(const std::vector<Chart>&);

/// What gnuplot is told.
std::string script(const std::vector<Chart>&);

/// What is left of gnuplot's output, which holds one document per chart.
std::vector<std::string> clean(const std::string& output, const std::vector<Chart>&);

}  // namespace lab::report
