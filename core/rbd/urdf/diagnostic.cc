#include "rbd/urdf/diagnostic.h"

#include <algorithm>
#include <ostream>

namespace rbd::urdf {
namespace {

std::string joined_errors(const std::vector<Diagnostic>& diagnostics) {
  std::string text;
  for (const Diagnostic& d : diagnostics) {
    if (d.severity == Severity::Error) text += (text.empty() ? "" : "\n") + d.text();
  }
  return text;
}

// A message is one line whatever a file's author put into a name.
std::string one_line(std::string text) {
  for (char& c : text) {
    if (static_cast<unsigned char>(c) < ' ' || c == 0x7f) c = ' ';
  }
  return text;
}

}  // namespace

std::string Diagnostic::text() const {
  std::string out = file;
  if (line > 0) out += ":" + std::to_string(line);
  out += ": ";
  if (severity == Severity::Warning) out += "warning: ";
  if (severity == Severity::Note) out += "note: ";
  if (!element.empty()) out += element + ": ";
  return one_line(out + message);
}

std::ostream& operator<<(std::ostream& out, const Diagnostic& diagnostic) { return out << diagnostic.text(); }

Error::Error(std::vector<Diagnostic> diagnostics)
    : std::invalid_argument(joined_errors(diagnostics)), diagnostics_(std::move(diagnostics)) {}

void Report::add(Severity severity, int line, std::string element, std::string message) {
  failed_ = failed_ || severity == Severity::Error;
  list_.push_back({severity, file_, line, std::move(element), std::move(message)});
}

void Report::add(const std::vector<Diagnostic>& others) {
  for (const Diagnostic& d : others) add(d.severity, d.line, d.element, d.message);
}

void Report::error(int line, std::string element, std::string message) {
  add(Severity::Error, line, std::move(element), std::move(message));
}
void Report::warn(int line, std::string element, std::string message) {
  add(Severity::Warning, line, std::move(element), std::move(message));
}
void Report::note(int line, std::string element, std::string message) {
  add(Severity::Note, line, std::move(element), std::move(message));
}

void Report::refuse_warnings() {
  for (Diagnostic& d : list_) {
    if (d.severity == Severity::Warning) d.severity = Severity::Error;
    failed_ = failed_ || d.severity == Severity::Error;
  }
}

std::vector<Diagnostic> Report::take() {
  std::stable_sort(list_.begin(), list_.end(), [](const Diagnostic& a, const Diagnostic& b) {
    return a.line != b.line ? a.line < b.line : a.severity > b.severity;
  });
  return std::move(list_);
}

}  // namespace rbd::urdf
