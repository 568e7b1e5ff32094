#include "rbd/urdf/xml.h"

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <set>
#include <vector>

#include "rbd/model/near_names.h"

namespace rbd::urdf {
namespace {

using tinyxml2::XMLElement;

constexpr std::string_view kBlank = " \t\r\n";

bool is_blank(std::string_view text) { return text.find_first_not_of(kBlank) == std::string_view::npos; }

// Next word of `text`, which loses it; empty at the end.
std::string_view next_word(std::string_view& text) {
  const size_t begin = text.find_first_not_of(kBlank);
  if (begin == std::string_view::npos) return text = {};
  text.remove_prefix(begin);
  const size_t end = std::min(text.find_first_of(kBlank), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

std::vector<std::string> words_of(std::string_view text) {
  std::vector<std::string> out;
  for (std::string_view word = next_word(text); !word.empty(); word = next_word(text)) out.emplace_back(word);
  return out;
}

bool has_word(std::string_view words, std::string_view word) {
  while (true) {
    const std::string_view next = next_word(words);
    if (next.empty()) return false;
    if (next == word) return true;
  }
}

// Empty if `word` is a finite number within the bound, else what is wrong with it.
std::string parse_number(std::string_view word, double bound, double& out) {
  std::string_view digits = word;
  if (digits.size() > 1 && digits[0] == '+' && digits[1] != '-') digits.remove_prefix(1);
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), out);
  const std::string quoted = "'" + std::string(word) + "'";
  if (code == std::errc::result_out_of_range) return quoted + " is out of range";
  if (code != std::errc() || end != digits.data() + digits.size()) {
    if (word.find(',') != std::string_view::npos)
      return quoted + " is not a number: write points, not commas";
    if (word.find("${") != std::string_view::npos)
      return quoted + " is xacro: expand the file with xacro first";
    return quoted + " is not a number";
  }
  if (!std::isfinite(out)) return quoted + " is not finite";
  if (std::abs(out) > bound) return quoted + " is too large (at most " + show(bound) + ")";
  return {};
}

// What may stand in an element, as lists of words.
struct Grammar {
  std::string_view element;
  std::string_view attributes;
  std::string_view once;    // children, at most one each
  std::string_view many;    // children, any number
  std::string_view unread;  // known elsewhere, of no use here: a note instead of a warning
};

constexpr Grammar kGrammar[] = {
    {"robot", "name version", "", "link joint material", "gazebo transmission sensor group"},
    {"link", "name type", "inertial", "visual collision", "contact self_collision_checking sensor"},
    {"inertial", "", "origin mass inertia", "", ""},
    {"mass", "value", "", "", ""},
    {"inertia", "ixx ixy ixz iyy iyz izz", "", "", ""},
    {"origin", "xyz rpy", "", "", ""},
    {"visual", "name", "origin geometry material", "", "meta"},
    {"collision", "name", "origin geometry", "", "material verbose contact_coefficients"},
    {"geometry", "", "box cylinder sphere capsule mesh", "", ""},
    {"box", "size", "", "", ""},
    {"cylinder", "radius length", "", "", ""},
    {"capsule", "radius length", "", "", ""},
    {"sphere", "radius", "", "", ""},
    {"mesh", "filename scale", "", "", ""},
    {"material", "name", "color", "", "texture"},
    {"color", "rgba", "", "", ""},
    {"joint", "name type", "origin parent child axis limit dynamics mimic safety_controller", "",
     "calibration"},
    {"parent", "link", "", "", ""},
    {"child", "link", "", "", ""},
    {"axis", "xyz", "", "", ""},
    {"limit", "lower upper effort velocity", "", "", ""},
    {"dynamics", "damping friction", "", "", ""},
    {"mimic", "joint multiplier offset", "", "", ""},
    {"safety_controller", "soft_lower_limit soft_upper_limit k_position k_velocity", "", "", ""},
};

const Grammar* find_grammar(std::string_view element) {
  for (const Grammar& row : kGrammar) {
    if (row.element == element) return &row;
  }
  return nullptr;
}

// Elements and attributes that are passed over, counted by kind: one line for a hundred <gazebo> blocks.
struct PassedOver {
  struct Kind {
    Severity severity;
    int line;
    int count = 0;
    std::string owner;
    std::string hint;
  };
  std::map<std::string, Kind> kinds;

  void add(const std::string& what, Severity severity, int line, const std::string& owner,
           const std::string& hint = "") {
    ++kinds.try_emplace(what, Kind{severity, line, 0, owner, hint}).first->second.count;
  }
  void report_to(Report& report) const {
    for (const auto& [what, kind] : kinds) {
      const std::string more = kind.count > 1 ? " (" + std::to_string(kind.count) + " times)" : "";
      report.add(kind.severity, kind.line, kind.owner, what + " is not read" + more + kind.hint);
    }
  }
};

void walk(const XMLElement& element, const Grammar& grammar, const std::string& owner, PassedOver& passed,
          bool& xacro, Report& report) {
  const std::string tag = "<" + std::string(grammar.element) + ">";
  for (const tinyxml2::XMLAttribute* a = element.FirstAttribute(); a; a = a->Next()) {
    const std::string_view name = a->Name();
    if (has_word(grammar.attributes, name) || name.starts_with("xmlns")) continue;
    const Severity severity = name.find(':') == name.npos ? Severity::Warning : Severity::Note;
    passed.add(
        "attribute '" + std::string(name) + "' of " + tag, severity, a->GetLineNum(), owner,
        severity == Severity::Note ? "" : did_you_mean(std::string(name), words_of(grammar.attributes)));
  }

  std::set<std::string_view> seen;
  for (const tinyxml2::XMLNode* node = element.FirstChild(); node; node = node->NextSibling()) {
    if (const tinyxml2::XMLText* text = node->ToText(); text && !is_blank(text->Value())) {
      std::string_view rest = text->Value();
      report.warn(node->GetLineNum(), owner,
                  "text in " + tag + " is not read ('" + std::string(next_word(rest)) + "' ..)");
    }
    const XMLElement* child = node->ToElement();
    if (!child) continue;
    const std::string_view name = child->Name();
    const std::string child_tag = "<" + std::string(name) + ">";

    if (name.starts_with("xacro:")) {
      if (!xacro) report.error(child->GetLineNum(), owner, child_tag + ": expand the file with xacro first");
      xacro = true;
    } else if (has_word(grammar.once, name) || has_word(grammar.many, name)) {
      if (has_word(grammar.once, name) && !seen.insert(name).second) {
        report.error(child->GetLineNum(), owner, "a second " + child_tag + " in " + tag + ": one is allowed");
      }
      const bool named = grammar.element == "robot";
      walk(*child, *find_grammar(name), named ? owner_of(*child) : owner, passed, xacro, report);
    } else if (grammar.element == "geometry") {
      report.error(child->GetLineNum(), owner,
                   "unknown shape " + child_tag + " (known: " + std::string(grammar.once) + ")" +
                       did_you_mean(std::string(name), words_of(grammar.once)));
    } else {
      const bool known = has_word(grammar.unread, name) || name.find(':') != name.npos;
      std::vector<std::string> read = words_of(grammar.once);
      for (const std::string& word : words_of(grammar.many)) read.push_back(word);
      passed.add(child_tag + " in " + tag, known ? Severity::Note : Severity::Warning, child->GetLineNum(),
                 owner, known ? "" : did_you_mean(std::string(name), read));
    }
  }
}

// Where the first bytes stand that are not UTF-8; npos if all are.
size_t first_not_utf8(const std::string& text) {
  for (size_t at = 0; at < text.size();) {
    const unsigned char lead = static_cast<unsigned char>(text[at]);
    const size_t length = lead < 0x80   ? 1
                          : lead < 0xc2 ? 0
                          : lead < 0xe0 ? 2
                          : lead < 0xf0 ? 3
                          : lead < 0xf5 ? 4
                                        : 0;
    if (length == 0 || at + length > text.size()) return at;
    for (size_t k = 1; k < length; ++k) {
      if ((static_cast<unsigned char>(text[at + k]) & 0xc0) != 0x80) return at;
    }
    at += length;
  }
  return std::string::npos;
}

// What tinyxml2 calls by a number.
std::string in_words(tinyxml2::XMLError error) {
  switch (error) {
    case tinyxml2::XML_ERROR_PARSING_ELEMENT:
      return "this element is unfinished";
    case tinyxml2::XML_ERROR_PARSING_ATTRIBUTE:
      return "an attribute is written name=\"value\", each only once";
    case tinyxml2::XML_ERROR_PARSING_TEXT:
      return "text outside of every element";
    case tinyxml2::XML_ERROR_PARSING_CDATA:
    case tinyxml2::XML_ERROR_PARSING_COMMENT:
    case tinyxml2::XML_ERROR_PARSING_DECLARATION:
    case tinyxml2::XML_ERROR_PARSING_UNKNOWN:
      return "this comment, <!..> or <?..> has no end, or stands where it may not";
    case tinyxml2::XML_ERROR_MISMATCHED_ELEMENT:
      return "this element is closed by another's tag";
    case tinyxml2::XML_ERROR_PARSING:
      return "this element is not closed";
    case tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED:
      return "elements are nested too deeply";
    default:
      return tinyxml2::XMLDocument::ErrorIDToName(error);
  }
}

}  // namespace

const XMLElement* parse_robot(const std::string& text, tinyxml2::XMLDocument& document, Report& report) {
  const auto refuse = [&](int line, const std::string& message) -> const XMLElement* {
    report.error(line, "", message);
    return nullptr;
  };
  const auto line_at = [&](size_t at) {
    return 1 +
           static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  };
  if (is_blank(text)) return refuse(0, "the file is empty");
  if (const size_t at = text.find('\0'); at != text.npos) {
    return refuse(line_at(at), "a zero byte: this is not XML in UTF-8");
  }
  if (const size_t at = first_not_utf8(text); at != text.npos)
    report.warn(line_at(at), "",
                "bytes that are not UTF-8: save the file in that encoding, or names get lost");
  if (const size_t at = text.find("<!ENTITY"); at != text.npos) {
    return refuse(line_at(at), "entity declarations are refused (<!ENTITY)");
  }
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    // "Error=XML_ERROR_MISMATCHED_ELEMENT ErrorID=14 (0xe) Line number=3: XMLElement name=link"
    const std::string what = document.ErrorStr();
    const size_t detail = what.find(": ");
    std::string message = "not well-formed XML: " + in_words(document.ErrorID());
    if (detail != what.npos) message += " (" + what.substr(detail + 2) + ")";
    return refuse(document.ErrorLineNum(), message);
  }

  const XMLElement* robot = nullptr;
  for (const tinyxml2::XMLNode* node = document.FirstChild(); node; node = node->NextSibling()) {
    if (node->ToText() && !is_blank(node->Value()))
      return refuse(node->GetLineNum(), "text outside of <robot>");
    const XMLElement* element = node->ToElement();
    if (!element) continue;
    if (robot || std::string_view(element->Name()) != "robot") {
      const std::string here = std::string(robot ? "another <" : "<") + element->Name() + ">";
      return refuse(element->GetLineNum(), "a URDF is one <robot>, here is " + here);
    }
    robot = element;
  }
  return robot ? robot : refuse(0, "there is no <robot>");
}

void check_vocabulary(const XMLElement& robot, Report& report) {
  PassedOver passed;
  bool xacro = false;
  walk(robot, *find_grammar("robot"), owner_of(robot), passed, xacro, report);
  passed.report_to(report);
}

int line_of(const XMLElement& element, const char* attribute) {
  const tinyxml2::XMLAttribute* found = attribute ? element.FindAttribute(attribute) : nullptr;
  return found ? found->GetLineNum() : element.GetLineNum();
}

bool read_numbers(const XMLElement& element, const char* attribute, const std::string& owner,
                  std::span<double> out, Report& report, double bound) {
  const char* text = element.Attribute(attribute);
  const std::string tag = std::string("<") + element.Name() + "> ";
  if (!text) {
    report.error(element.GetLineNum(), owner, tag + "has no '" + attribute + "'");
    return false;
  }
  const int line = line_of(element, attribute);
  const std::string seen = tag + attribute + "=\"" + text + "\": ";

  std::vector<double> values;
  for (std::string_view rest = text;;) {
    const std::string_view word = next_word(rest);
    if (word.empty()) break;
    double value = 0;
    if (const std::string wrong = parse_number(word, bound, value); !wrong.empty()) {
      report.error(line, owner, seen + wrong);
      return false;
    }
    values.push_back(value);
  }
  if (values.size() != out.size()) {
    report.error(line, owner,
                 seen + "needs " + std::to_string(out.size()) + (out.size() == 1 ? " number" : " numbers") +
                     ", has " + std::to_string(values.size()));
    return false;
  }
  std::copy(values.begin(), values.end(), out.begin());
  return true;
}

bool read_number(const XMLElement& element, const char* attribute, const std::string& owner, double& out,
                 Report& report, double bound) {
  return read_numbers(element, attribute, owner, std::span(&out, 1), report, bound);
}

std::string read_text(const XMLElement& element, const char* attribute, const std::string& owner,
                      Report& report) {
  const char* text = element.Attribute(attribute);
  if (text && (std::string_view(text).find("${") != std::string_view::npos ||
               std::string_view(text).find("$(") != std::string_view::npos)) {
    report.error(line_of(element, attribute), owner,
                 std::string("'") + text + "' is xacro: expand the file with xacro first");
    return {};
  }
  if (text && !is_blank(text)) return text;
  report.error(
      line_of(element, attribute), owner,
      std::string("<") + element.Name() + (text ? "> has an empty '" : "> has no '") + attribute + "'");
  return {};
}

std::string owner_of(const XMLElement& element) {
  const char* name = element.Attribute("name");
  return name && *name ? element.Name() + (" '" + std::string(name)) + "'" : element.Name();
}

std::string did_you_mean(const std::string& name, const std::vector<std::string>& known) {
  std::string out;
  for (const std::string& near : nearNames(name, known, 2)) out += (out.empty() ? "" : "' or '") + near;
  return out.empty() ? out : "; did you mean '" + out + "'?";
}

std::string show(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value, std::chars_format::general, 6).ptr};
}

std::string exactly(double value) {
  char digits[32];
  return {digits, std::to_chars(digits, digits + sizeof digits, value).ptr};
}

namespace {

template <class Text>
std::string in_brackets(std::span<const double> values, Text text) {
  std::string out;
  for (const double value : values) out += (out.empty() ? "(" : " ") + text(value);
  return out + ")";
}

}  // namespace

std::string show(std::span<const double> values) {
  return in_brackets(values, [](double value) { return show(value); });
}

std::string exactly(std::span<const double> values) {
  return in_brackets(values, [](double value) { return exactly(value); });
}

}  // namespace rbd::urdf
