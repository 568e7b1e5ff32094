// Experiments as text: experiments/*.yaml, the experiment.yaml of a run's folder, and the text that RUN
// carries. What needs the robot (joint names, vector sizes, limits) is checked later, where the vectors are
// made.
#pragma once
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "lab/experiment/experiment.h"

namespace lab {

/// Reads an experiment from YAML. `overrides` are "a.b=value", applied over the text. Missing keys get
/// defaults. Throws ExperimentError with one line per fault: "FILE:LINE: controller.kp: must be .., not
/// 'abc'".
Experiment parse_experiment(const std::string& text, const std::string& file,
                            const std::vector<std::string>& overrides = {});

/// One override, and where it was written ("FILE:LINE"): messages about its value begin with that.
struct Override {
  std::string text;
  std::string place = "--set";
};
Experiment parse_experiment(const std::string& text, const std::string& file,
                            std::span<const Override> overrides);

/// The same from a file; a missing one is an ExperimentError too.
Experiment load_experiment(const std::string& file, const std::vector<std::string>& overrides = {});

/// The file's text, or an ExperimentError.
std::string experiment_text(const std::string& file);

/// Every key as run, defaults written out: the experiment.yaml of a run's folder. parse_experiment gives it
/// back.
std::string resolve(const Experiment&);

/// Every key in the order of the file with its value as text; empty where it is not given.
std::vector<std::pair<std::string, std::string>> key_values(const Experiment&);

/// The text for RUN: fixed order, %.17g, only keys that can change the log; a model file is written "urdf",
/// since its text is another field. parse_experiment gives back an experiment that runs the same.
std::string canonical(const Experiment&);

/// docs/experiments.md's table of keys.
std::string key_table();

}  // namespace lab
