#pragma once
#include <string>
#include <vector>

/// What lab-experiment report and compare do.
namespace lab::report {

/// Writes RUN/report.html of each and prints its path.
void report_runs(const std::vector<std::string>& dirs);

/// Prints the comparison, as JSON or as text, and writes the page to `file`, unless that is empty.
void compare_runs(const std::vector<std::string>& dirs, const std::string& file, bool as_json);

}  // namespace lab::report
