// The command lines of all programs: one parser, and one style in which a program says what is wrong. The parser is CLI11, whose
// header costs ten seconds of compile time in each file that includes it: only command_line.cc does.
#pragma once
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lab {

/// An option or a positional word; a copy is the same one. Each function returns it, for the next.
class Option {
 public:
  Option required();
  Option needs(Option);
  Option excludes(Option);
  Option env(const std::string& variable);  ///< where the value comes from if it is not given
  Option show_default();                    ///< in the help: the value that it has now
  Option positive();                        ///< a number above 0
  Option range(double least, double most);
  Option one_of(std::vector<std::string> words);
  Option check(std::function<std::string(const std::string&)> fault);  ///< "" or what is wrong with the word
  Option one_word();                  ///< of a list: each time that the option is given it takes one word
  Option many_words();                ///< of a list: all words up to the next option
  Option count(int least, int most);  ///< of a list
  Option separated_by(char);          ///< of a list
  bool given() const;

 private:
  friend class CommandLine;
  explicit Option(CLI::Option* option) : option_(option) {}
  CLI::Option* option_;
};

class CommandLine {
 public:
  CommandLine(const std::string& program, const std::string& purpose);

  /// `names`: "-o,--output", or a word without dashes for a positional.
  Option option(const std::string& names, std::string& value, const std::string& help);
  Option option(const std::string& names, std::optional<std::string>& value, const std::string& help);
  Option option(const std::string& names, int& value, const std::string& help);
  Option option(const std::string& names, int64_t& value, const std::string& help);
  Option option(const std::string& names, std::optional<int64_t>& value, const std::string& help);
  Option option(const std::string& names, double& value, const std::string& help);
  Option option(const std::string& names, std::optional<double>& value, const std::string& help);
  Option option(const std::string& names, std::vector<std::string>& values, const std::string& help);
  Option option(const std::string& names, std::vector<double>& values, const std::string& help);
  /// `take` gets the word; it returns "" or what is wrong with it.
  Option read(const std::string& names, std::function<std::string(const std::string&)> take,
              const std::string& help);
  Option flag(const std::string& names, bool& value, const std::string& help);

  /// Subcommands; the returned one lives as long as this.
  CommandLine verb(const std::string& name, const std::string& what);
  void needs_verb();
  /// Options of this one may stand behind the verb, too.
  void options_behind_verbs();
  /// The words of a list need not be the last ones.
  void options_between_words();
  void footer(const std::string& text);
  /// Called when all words have been read: "" or what is wrong with them together.
  void check(std::function<std::string()> fault);

  /// Nothing if the program is to go on, else its exit code: after --help and --version, and after a mistake, which is one line
  /// on stderr. Adds --version.
  std::optional<int> parse(int argc, char** argv);
  /// The name of the verb that was given; "" without.
  std::string chosen() const;

 private:
  explicit CommandLine(std::shared_ptr<CLI::App> app) : app_(std::move(app)) {}
  std::shared_ptr<CLI::App> app_;
};

/// How the person called this program: "lab run" where a verb called it (LAB_VERB), else its own name.
std::string called(const std::string& program);

/// Says what is wrong on stderr, every line after the program's name.
void complain(const std::string& program, const std::string& what);

/// Complains about why the program does not do what was asked; under --json it says so on stdout too:
/// {"error": .., "exit_code": ..}. Returns the code.
int refuse(const std::string& program, const std::string& why, int code);

}  // namespace lab
