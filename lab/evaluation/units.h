// Units of metrics for one robot. A metric over joints has "rad" where they turn and "m" where they slide: a figure has
// the one or the other, never both.
#pragma once
#include <rbd/model/model.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace lab {

/// Whether the joint at this place in v slides, so that it counts in m and N; others count in rad and Nm.
bool slides(const rbd::Model&, int iv);

/// Of "rad, m", as tables of metrics and keys write what is the one for joints that turn and the other for those that slide,
/// the one that this joint has, or all joints of the robot (joint empty); of a robot with both "rad or m". Other units as
/// they are.
std::string chosen_unit(const std::string& unit, const rbd::Model&, const std::string& joint = "");

/// Of a metric, or of "max_error.elbow"; "" if it has none. A metric over joints of both kinds: "rad or m".
std::string unit_of(const std::string& metric, const rbd::Model&);

/// A value of a metric.
struct Figure {
  double value = 0;  ///< NaN: it has none
  std::string unit;
  std::string joint{};  ///< whose value it is, where the metric is the largest or least of several joints
};

/// What finished metrics (or one of their reaches, with metrics as names) have of a metric over all joints: one figure, or,
/// where its unit depends on the joint and the robot has both kinds, one of the joints that turn and one of those that slide.
std::vector<Figure> figures_of(const nlohmann::json& metrics, const std::string& metric, const rbd::Model&);

/// The same of the joints of one kind alone.
Figure figure_over(const nlohmann::json& metrics, const std::string& metric, const rbd::Model&, bool sliding);

/// The value of a bounded metric, as value_of(), with the unit and the joint that it has.
Figure figure_of(const nlohmann::json& metrics, const std::string& metric, const rbd::Model&);

}  // namespace lab
