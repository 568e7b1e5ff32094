#include "core/util/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/util/exit_code.h"
#include "core/util/json_text.h"
#include "core/util/version.h"

namespace lab {
namespace {

bool wants_json = false;

/// The subcommand that was being parsed, or the program.
const CLI::App& innermost(const CLI::App& app) {
  const auto chosen = app.get_subcommands();
  return chosen.empty() ? app : innermost(*chosen.front());
}

std::string names_of_verbs(const CLI::App& app) {
  std::string names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; }))
    names += (names.empty() ? "" : ", ") + verb->get_name();
  return names;
}

std::string mistake(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& verb = innermost(app);
  const std::string verbs = names_of_verbs(app);
  if (const std::vector<std::string> rest = app.remaining(true);
      !rest.empty() && error.get_name() == "ExtrasError") {
    if (rest[0].starts_with("-")) return "unknown option '" + rest[0] + "'";
    if (&verb == &app && !verbs.empty()) return "there is no verb '" + rest[0] + "'; there are " + verbs;
    return "unexpected argument '" + rest[0] + "'";
  }
  if (&verb == &app && !verbs.empty() && error.get_name() == "RequiredError")
    return "no verb given; there are " + verbs;
  return error.what();
}

}  // namespace

std::string called(const std::string& program) {
  const char* verb = std::getenv("LAB_VERB");
  return verb && *verb ? verb : program;
}

void complain(const std::string& program, const std::string& what) {
  const std::string name = called(program);
  std::stringstream lines(what);
  for (std::string line; std::getline(lines, line);) fmt::print(stderr, "{}: {}\n", name, line);
}

int refuse(const std::string& program, const std::string& why, int code) {
  complain(program, why);
  if (wants_json) fmt::print("{}\n", json_text(nlohmann::ordered_json{{"error", why}, {"exit_code", code}}));
  return code;
}

std::optional<int> parse_command_line(CLI::App& app, int argc, char** argv) {
  app.set_version_flag("--version", app.get_name() + " " + kVersion + " (commit " + commit() + ")");
  for (int i = 1; i < argc; ++i) wants_json |= std::string(argv[i]) == "--json";
  try {
    app.parse(argc, argv);
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error) == 0 ? kOk : kUsage;
    const CLI::App& verb = innermost(app);
    const std::string own = app.get_name(), below = &verb == &app ? "" : " " + verb.get_name();
    const bool by_verb = called(own) != own;
    return refuse(
        own,
        mistake(app, error) + " (see: " + (by_verb ? "scripts/" + called(own) : own + below) + " --help)",
        kUsage);
  }
}

}  // namespace lab
