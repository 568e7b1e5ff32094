#pragma once
#include <string>

#include "lab/report/folder.h"

/// report.html: one run on one page.
namespace lab::report {

struct Page {
  std::string html;
  bool drawn = true;  ///< false: without plots, for there is no gnuplot
};

/// The same folder gives the same bytes. Throws std::runtime_error with what gnuplot complains about.
Page run_page(const Folder&);

/// "passed", "failed", or how it ended otherwise; and whether that is good.
struct Badge {
  std::string text;
  bool good = false;
};
Badge badge_of(const Folder&);

/// What a run is about, in one line: robot, planner, controller, time.
std::string about(const Folder&);

std::string badge_html(const Badge&);

}  // namespace lab::report
