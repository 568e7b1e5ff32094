// The verbs of lab-experiment, one function each (`sweep` is in sweep_verb.h). They return the exit code, and
// throw for bad experiments, robots and files.
#pragma once
#include <string>
#include <vector>

#include "lab/tool/manifest.h"

namespace lab {

/// The command-line options of all verbs.
struct Options {
  std::vector<std::string> files, set, exits;
  std::string file, out, run_dir = ".", restart = "never";
  std::string ended_run, name, reason, junit;  ///< of verdict
  int code = 0;
  Launch launch;
  bool as_json = false, stay = false;
};

int check_files(const Options&);
int resolve_file(const Options&);
int list_processes(const Options&);
int evaluate_run(const Options&);
int write_manifest(Options);
int report_runs(const Options&);
int compare_runs(const Options&);
int list_keys(const Options&);
int tell_verdict(const Options&);

}  // namespace lab
