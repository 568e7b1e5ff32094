#include "core/util/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/util/console.h"
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

/// The first word that nothing took: an option, if there is one, since the words behind it are its own; "" if there is none.
std::string unexpected_word(const CLI::App& app, int argc, char** argv) {
  const std::vector<std::string> rest = app.remaining(true);
  for (const bool options : {true, false})
    for (int i = 1; i < argc; ++i)
      if (const std::string word = argv[i];
          (!options || word.starts_with("-")) && std::find(rest.begin(), rest.end(), word) != rest.end())
        return word;
  return "";
}

std::string mistake(const CLI::App& app, const CLI::ParseError& error, int argc, char** argv) {
  const bool outside = &innermost(app) == &app;
  const std::string verbs = outside ? names_of_verbs(app) : "";
  const bool no_verb = !verbs.empty() && dynamic_cast<const CLI::RequiredError*>(&error);
  const std::string word =
      no_verb || dynamic_cast<const CLI::ExtrasError*>(&error) ? unexpected_word(app, argc, argv) : "";
  if (word.starts_with("-")) return "unknown option '" + word + "'";
  if (!word.empty() && !verbs.empty()) return "there is no verb '" + word + "'; there are " + verbs;
  if (!word.empty()) return "unexpected argument '" + word + "'";
  if (no_verb) return "no verb given; there are " + verbs;
  std::string text = error.what();
  // CLI11 writes the bound of a positive number with all its 309 digits
  if (const size_t at = text.find(" not in range 0"); at != std::string::npos && text.size() > at + 300)
    text = text.substr(0, at) + " must be above 0";
  if (const size_t comma = text.rfind(',');
      dynamic_cast<const CLI::ConversionError*>(&error) && comma != std::string::npos)
    text += " (a decimal comma? write a point)";
  return text;
}

}  // namespace

std::string called(const std::string& program) {
  const char* verb = std::getenv("LAB_VERB");
  return verb && *verb ? verb : program;
}

void complain(const std::string& program, const std::string& what) {
  const std::string name = called(program);
  std::stringstream lines(what);
  for (std::string line; std::getline(lines, line);) say("{}: {}", name, line);
}

int refuse(const std::string& program, const std::string& why, int code) {
  complain(program, why);
  if (wants_json) emit("{}\n", json_text(nlohmann::ordered_json{{"error", why}, {"exit_code", code}}));
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
    return refuse(own,
                  mistake(app, error, argc, argv) +
                      " (see: " + (by_verb ? "scripts/" + called(own) : own + below) + " --help)",
                  kUsage);
  }
}

}  // namespace lab
