// report.html: one run on one page.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lab/report/folder.h"

namespace lab::report {

/// The page as HTML. The same folder gives the same bytes.
std::string run_page(const Folder&);

/// "as expected", "timed out", ..; and whether that is good. For the template badge.html.
nlohmann::json badge_of(const Folder&);

/// What a run is about, in one line: robot, planner, controller, time.
std::string about(const Folder&);

}  // namespace lab::report
