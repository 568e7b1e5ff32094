// What was found while a robot file was read: diagnostics are values, nothing is printed.
#pragma once

#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

namespace rbd::urdf {

enum class Severity {
  Note,     // left out or adapted, as other readers do: <gazebo> blocks, an axis that was normalised
  Warning,  // usable, but look at it: a mesh that is missing, a moving link without mass
  Error     // refused
};

struct Diagnostic {
  Severity severity = Severity::Error;
  std::string file;     // as given by the caller
  int line = 0;         // from 1; 0 when it concerns the whole file
  std::string element;  // "link 'hand'", "joint 'elbow'", "robot 'panda'"; may be empty
  std::string message;  // what is wrong, with the value seen and what to do

  // "FILE:LINE: link 'hand': what is wrong"; a warning or a note says so before the element.
  std::string text() const;
};

std::ostream& operator<<(std::ostream& out, const Diagnostic& diagnostic);

// Thrown by the forms that return no result. what() holds every error, one line each.
class Error : public std::invalid_argument {
 public:
  explicit Error(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }  // warnings and notes too

 private:
  std::vector<Diagnostic> diagnostics_;
};

// Collects diagnostics of one file. Used by the reader's parts, in this order: text, elements, tree, model.
class Report {
 public:
  explicit Report(std::string file) : file_(std::move(file)) {}

  void add(Severity severity, int line, std::string element, std::string message);
  void error(int line, std::string element, std::string message);
  void warn(int line, std::string element, std::string message);
  void note(int line, std::string element, std::string message);

  void add(const std::vector<Diagnostic>& others);

  // Turns every warning into an error.
  void refuse_warnings();

  bool failed() const { return failed_; }
  const std::string& file() const { return file_; }
  std::vector<Diagnostic> take();  // sorted by line; errors first among equals

 private:
  std::string file_;
  bool failed_ = false;
  std::vector<Diagnostic> list_;
};

}  // namespace rbd::urdf
