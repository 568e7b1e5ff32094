#include "core/util/command_line.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
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
  const bool missing = dynamic_cast<const CLI::RequiredError*>(&error), no_verb = !verbs.empty() && missing;
  std::string word =
      missing || dynamic_cast<const CLI::ExtrasError*>(&error) ? unexpected_word(app, argc, argv) : "";
  if (word.starts_with("-")) return "unknown option '" + word + "'";
  if (missing && !no_verb) word.clear();
  if (!word.empty() && !verbs.empty()) return "there is no verb '" + word + "'; there are " + verbs;
  if (!word.empty()) return "unexpected argument '" + word + "'";
  if (no_verb) return "no verb given; there are " + verbs;
  std::string text = error.what();
  if (dynamic_cast<const CLI::ArgumentMismatch*>(&error))
    if (const size_t at = text.find(": 1 required "); at != std::string::npos)
      return text.substr(0, at) + " needs a value";
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

namespace {

/// Why a word is no number that `is_right`; "" if it is one.
std::string number_fault(const std::string& word, const std::string& wanted,
                         const std::function<bool(double)>& is_right) {
  char* end = nullptr;
  const double value = std::strtod(word.c_str(), &end);
  if (!word.empty() && *end == '\0' && is_right(value)) return "";
  return "must be a number" + (wanted.empty() ? "" : " " + wanted) + ", not '" + word + "'" +
         (word.find(',') == std::string::npos ? "" : " (a decimal comma? write a point)");
}

}  // namespace

Option Option::required() { return Option(option_->required()); }
Option Option::needs(Option other) { return Option(option_->needs(other.option_)); }
Option Option::excludes(Option other) { return Option(option_->excludes(other.option_)); }
Option Option::env(const std::string& variable) { return Option(option_->envname(variable)); }
Option Option::show_default() { return Option(option_->capture_default_str()); }
Option Option::positive() {
  return check([](const std::string& word) {
    return number_fault(word, "above 0", [](double x) { return x > 0 && std::isfinite(x); });
  });
}
Option Option::range(double least, double most) {
  return check([least, most](const std::string& word) {
    return number_fault(word, fmt::format("from {:g} to {:g}", least, most),
                        [&](double x) { return least <= x && x <= most; });
  });
}
Option Option::one_of(std::vector<std::string> words) {
  return Option(option_->check(CLI::IsMember(std::move(words))));
}
Option Option::check(std::function<std::string(const std::string&)> fault) {
  return Option(option_->check(std::move(fault)));
}
Option Option::one_word() { return Option(option_->allow_extra_args(false)); }
Option Option::many_words() { return Option(option_->allow_extra_args()); }
Option Option::count(int least, int most) { return Option(option_->expected(least, most)); }
Option Option::separated_by(char character) { return Option(option_->delimiter(character)); }
bool Option::given() const { return option_->count() > 0; }

CommandLine::CommandLine(const std::string& program, const std::string& purpose)
    : app_(std::make_shared<CLI::App>(purpose, program)) {}

namespace {

// CLI11's own conversions are templates that cost ten seconds to compile, and say "Could not convert".
template <typename T>
T number_of(const std::string& word) {
  T value{};
  const char* end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  constexpr bool kWhole = std::is_integral_v<T>;
  if (error != std::errc() || rest != end || !std::isfinite(static_cast<double>(value)))
    throw CLI::ValidationError(
        number_fault(word, kWhole ? "without a fraction" : "", [](double) { return false; }));
  return value;
}

CLI::Option* add(CLI::App& app, const std::string& names, const std::string& help, const char* type,
                 const std::function<void(const CLI::results_t&)>& take) {
  const auto callback = [take](const CLI::results_t& words) {
    take(words);
    return true;
  };
  return app.add_option(names, callback, help)->type_name(type);
}

template <typename Number, typename T>
CLI::Option* add_number(CLI::App& app, const std::string& names, const std::string& help, T& value) {
  return add(app, names, help, std::is_integral_v<Number> ? "INT" : "FLOAT",
             [&value](const CLI::results_t& words) { value = number_of<Number>(words.back()); });
}

}  // namespace

Option CommandLine::option(const std::string& names, std::string& value, const std::string& help) {
  CLI::Option* option =
      add(*app_, names, help, "TEXT", [&value](const CLI::results_t& words) { value = words.back(); });
  option->default_function([&value] { return value; });
  return Option(option);
}
Option CommandLine::option(const std::string& names, std::optional<std::string>& value,
                           const std::string& help) {
  return Option(
      add(*app_, names, help, "TEXT", [&value](const CLI::results_t& words) { value = words.back(); }));
}
Option CommandLine::option(const std::string& names, int& value, const std::string& help) {
  return Option(add_number<int>(*app_, names, help, value));
}
Option CommandLine::option(const std::string& names, int64_t& value, const std::string& help) {
  return Option(add_number<int64_t>(*app_, names, help, value));
}
Option CommandLine::option(const std::string& names, std::optional<int64_t>& value, const std::string& help) {
  return Option(add_number<int64_t>(*app_, names, help, value));
}
Option CommandLine::option(const std::string& names, double& value, const std::string& help) {
  return Option(add_number<double>(*app_, names, help, value));
}
Option CommandLine::option(const std::string& names, std::optional<double>& value, const std::string& help) {
  return Option(add_number<double>(*app_, names, help, value));
}
Option CommandLine::option(const std::string& names, std::vector<std::string>& values,
                           const std::string& help) {
  CLI::Option* option =
      add(*app_, names, help, "TEXT", [&values](const CLI::results_t& words) { values = words; });
  return Option(option->expected(CLI::detail::expected_max_vector_size));
}
Option CommandLine::option(const std::string& names, std::vector<double>& values, const std::string& help) {
  CLI::Option* option = add(*app_, names, help, "FLOAT", [&values](const CLI::results_t& words) {
    values.clear();
    for (const std::string& word : words) values.push_back(number_of<double>(word));
  });
  return Option(option->expected(CLI::detail::expected_max_vector_size));
}

Option CommandLine::read(const std::string& names, std::function<std::string(const std::string&)> take,
                         const std::string& help) {
  const auto each = [take = std::move(take)](const std::string& word) {
    if (const std::string fault = take(word); !fault.empty()) throw CLI::ValidationError(fault);
  };
  return Option(app_->add_option(names, help)->each(each));
}

Option CommandLine::flag(const std::string& names, bool& value, const std::string& help) {
  return Option(app_->add_flag(names, value, help));
}

CommandLine CommandLine::verb(const std::string& name, const std::string& what) {
  return CommandLine(std::shared_ptr<CLI::App>(app_, app_->add_subcommand(name, what)));
}
void CommandLine::needs_verb() { app_->require_subcommand(1); }
void CommandLine::options_behind_verbs() { app_->fallthrough(); }
void CommandLine::options_between_words() { app_->positionals_at_end(false); }
void CommandLine::footer(const std::string& text) { app_->footer(text); }
void CommandLine::check(std::function<std::string()> fault) {
  app_->final_callback([fault = std::move(fault)] {
    if (const std::string text = fault(); !text.empty()) throw CLI::ValidationError(text);
  });
}

std::string CommandLine::chosen() const {
  const auto verbs = app_->get_subcommands();
  return verbs.empty() ? "" : verbs.front()->get_name();
}

std::optional<int> CommandLine::parse(int argc, char** argv) {
  CLI::App& app = *app_;
  if (const auto verbs = app.get_subcommands([](const CLI::App*) { return true; });
      !verbs.empty() && app.get_require_subcommand_min() == 0)
    app.require_subcommand(0, 1);
  app.get_formatter()->column_width(34);
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
