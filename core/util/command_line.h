// The command lines of all programs: one parser, and one style in which a program says what is wrong.
#pragma once
#include <optional>
#include <string>

namespace CLI {
class App;
}

namespace lab {

/// Parses; nothing if the program is to go on, else its exit code: after --help and --version, and after a mistake, which is
/// one line on stderr. Adds --version.
std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv);

/// How the person called this program: "lab run" where a verb called it (LAB_VERB), else its own name.
std::string called(const std::string& program);

/// Says what is wrong on stderr, every line after the program's name.
void complain(const std::string& program, const std::string& what);

/// Complains about why the program does not do what was asked; under --json it says so on stdout too:
/// {"error": .., "exit_code": ..}. Returns the code.
int refuse(const std::string& program, const std::string& why, int code);

}  // namespace lab
