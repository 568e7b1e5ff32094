#include "lab/sweep/units.h"

#include "lab/evaluation/units.h"
#include "lab/experiment/keys.h"
#include "lab/experiment/live_gains.h"
#include "lab/sweep/workbench.h"

namespace lab::sweep {

Units::Units(const Sweep& sweep) {
  try {
    Workbench bench(sweep);
    const Workbench::Job first = bench.prepare(0);
    model_ = first.robot->model;
    experiment_ = first.experiment;
  } catch (const std::exception&) {
    model_ = rbd::Model();  // the page says what became of its runs
  }
}

std::string Units::of_key(const std::string& key) const {
  std::string unit, joint;
  for_each_key(experiment_, [&](const Key& known, const auto&) {
    const std::string name = known.name;
    if (key != name && !key.starts_with(name + ".")) return;
    unit = known.unit;
    joint = key.size() > name.size() ? key.substr(name.size() + 1) : "";
  });
  return chosen_unit(unit_for_law(unit, experiment_.controller.kind), model_, joint);
}

std::string Units::of_metric(const std::string& metric) const { return unit_of(metric, model_); }

std::string Units::with_unit(const std::string& name) const {
  const std::string metric = of_metric(name), unit = metric.empty() ? of_key(name) : metric;
  return unit.empty() ? name : name + " (" + unit + ")";
}

}  // namespace lab::sweep
