#include "lab/tool/report_verbs.h"

#include <iostream>

#include "core/util/atomic_file.h"
#include "lab/report/compare.h"
#include "lab/report/report.h"

namespace lab::report {
namespace {

void write_page(const std::string& path, const Page& page) {
  if (!page.drawn)
    std::cerr << path << ": is without plots, for gnuplot is not installed (package gnuplot-nox)\n";
  write_atomically(path, page.html);
}

}  // namespace

void report_runs(const std::vector<std::string>& dirs) {
  for (const std::string& dir : dirs) {
    const std::string path = dir + (dir.ends_with('/') ? "" : "/") + "report.html";
    write_page(path, run_page(read_folder(dir)));
    std::cout << path << "\n";
  }
}

void compare_runs(const std::vector<std::string>& dirs, const std::string& file, bool as_json) {
  std::vector<Folder> runs;
  for (const std::string& dir : dirs) runs.push_back(read_folder(dir));
  const Comparison all = compare(runs);
  if (!file.empty()) write_page(file, compare_page(all, runs));
  if (as_json)
    std::cout << compare_json(all).dump(2) << "\n";
  else
    std::cout << compare_text(all);
}

}  // namespace lab::report
