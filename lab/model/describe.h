// What a robot is, as text and as JSON: joints with kinds and limits, masses, frames.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

#include "lab/model/robot.h"

namespace lab::model {

/// Sum of all that moves (kg): what stands on the ground does not count, as in the core.
double mass_of(const rbd::Model&);

/// Name, sizes, mass, joints, frames. A limit that does not exist is null; `idx_q`, `idx_v` of a joint that
/// mimics are those of the joint at the head of its chain.
nlohmann::ordered_json info_json(const Robot&);
/// The same as tables, ending with a newline.
std::string info_text(const Robot&);

/// Severity, place, element, message, and `text`: all of it as one line.
nlohmann::ordered_json to_json(const rbd::urdf::Diagnostic&);

/// "RZ", and what it mimics: "RZ = -1 finger_left + 0.5".
std::string kind_of(const rbd::Model&, rbd::JointIndex);

}  // namespace lab::model
