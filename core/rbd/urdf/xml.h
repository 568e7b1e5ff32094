// Reading XML strictly: numbers that are numbers, elements that are known, and the line of everything.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "rbd/urdf/diagnostic.h"

namespace tinyxml2 {
class XMLDocument;
class XMLElement;
}  // namespace tinyxml2

namespace rbd::urdf {

// Parses the text; on an error reports it and returns null. The element belongs to `document`.
// Refuses entity declarations (they can grow without bound), binary text, and anything but one <robot>.
const tinyxml2::XMLElement* parse_robot(const std::string& text, tinyxml2::XMLDocument& document,
                                        Report& report);

// Walks all of <robot> once and reports unknown, repeated and unread elements and attributes, stray text,
// and xacro that was not expanded. What is listed here is what the loader reads; the rest is ignored.
void check_vocabulary(const tinyxml2::XMLElement& robot, Report& report);

// Where an attribute stands: its own line if the element has it, else the element's.
int line_of(const tinyxml2::XMLElement& element, const char* attribute = nullptr);

inline constexpr double kNumberBound = 1e9;  // no length, mass, angle .. of a robot is larger

// Numbers of `attribute`, exactly out.size() of them, finite and at most `bound` in size. Otherwise a message,
// false, and `out` as it was. `owner` is how messages name it: "joint 'elbow'".
bool read_numbers(const tinyxml2::XMLElement& element, const char* attribute, const std::string& owner,
                  std::span<double> out, Report& report, double bound = kNumberBound);
bool read_number(const tinyxml2::XMLElement& element, const char* attribute, const std::string& owner,
                 double& out, Report& report, double bound = kNumberBound);

// Text of a required, non-blank attribute; empty and a message if it is missing, or still xacro.
std::string read_text(const tinyxml2::XMLElement& element, const char* attribute, const std::string& owner,
                      Report& report);

// "link 'hand'" from <link name="hand">; "link" if it has no name.
std::string owner_of(const tinyxml2::XMLElement& element);

// "; did you mean 'a' or 'b'?" with those of `known` that are close to `name`; empty if none is.
std::string did_you_mean(const std::string& name, const std::vector<std::string>& known);

// A number as a person would write it: 0.5, not 0.500000.
std::string show(double value);
// Several of them: "(0 0 2)".
std::string show(std::span<const double> values);

// The shortest text that reads back as the same number, whatever the locale.
std::string exactly(double value);
// Several of them: "(1.0000001 0 0 1)".
std::string exactly(std::span<const double> values);

}  // namespace rbd::urdf
