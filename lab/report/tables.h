// The figures of a run's page as values for its templates. Every number is in the unit of metrics.json and `expect`, in the
// tiles, in the tables and in the plots, so that the same quantity is the same number wherever it stands.
#pragma once
#include <rbd/model/model.h>

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "lab/evaluation/units.h"

namespace lab::report {

/// For figure.html: value, unit, joint (HTML), bad.
nlohmann::json shown(const Figure&, int digits = 4);

nlohmann::json key_figures(const nlohmann::json& metrics, const rbd::Model&);
nlohmann::json verdict_rows(const nlohmann::json& metrics, const rbd::Model&);
/// One table of the joints that turn, one of those that slide: each column has one unit.
nlohmann::json joint_tables(const nlohmann::json& metrics, const rbd::Model&);
nlohmann::json reach_rows(const nlohmann::json& metrics, const rbd::Model&);
nlohmann::json metric_rows(const nlohmann::json& metrics, const rbd::Model&);

/// "0.01 rad", "0.01 m", or both.
std::string band_in_words(double band, const rbd::Model&);

}  // namespace lab::report
