#include "wire/schema/schema_texts.h"

#include <map>
#include <set>

namespace lab {
namespace {

using Fault = std::function<void(const std::string&)>;

std::string place(const ParsedSource& parsed, int line) {
  return parsed.source.file + ":" + std::to_string(line) + ": ";
}

/// Why a text cannot be used beside those that have declared `known`; empty if it can: then its names are known, too.
std::string declared_twice(const ParsedSource& parsed, std::map<std::string, std::string>& known) {
  std::map<std::string, std::string> own;
  std::string why;
  const auto add = [&](const std::string& name, int line) {
    const auto before = known.find(name);
    const bool is_new = before == known.end() && own.emplace(name, parsed.source.file).second;
    if (!is_new && why.empty())
      why = place(parsed, line) + name + " is declared twice, before in " +
            (before == known.end() ? parsed.source.file : before->second);
  };
  const Declarations& declared = parsed.declared;
  for (size_t i = 0; i < declared.enums.size(); ++i)
    add("enum " + declared.enums[i].name, declared.enum_lines[i]);
  for (size_t i = 0; i < declared.types.size(); ++i)
    add("struct " + declared.types[i].name, declared.type_lines[i]);
  if (why.empty()) known.merge(own);
  return why;
}

/// The first member of a type that is not among the names; empty if there is none.
std::string unknown_type(const ParsedSource& parsed, const std::set<std::string>& names) {
  const Declarations& declared = parsed.declared;
  for (size_t t = 0; t < declared.types.size(); ++t) {
    const Type& type = declared.types[t];
    for (size_t i = 0; i < type.fields.size(); ++i) {
      const Field& f = type.fields[i];
      if (f.kind == Kind::Struct && !names.contains(f.type_name))
        return place(parsed, declared.field_lines[t][i]) + "member '" + f.name + "' of " + type.name +
               " has the unknown type '" + f.type_name + "'";
    }
  }
  return {};
}

/// Drops the texts for which `why_not` has an answer; true if there were any.
bool drop(std::vector<ParsedSource>& all, const Fault& fault,
          const std::function<std::string(const ParsedSource&)>& why_not) {
  return std::erase_if(all, [&](const ParsedSource& parsed) {
           const std::string why = why_not(parsed);
           if (!why.empty()) fault(why);
           return !why.empty();
         }) > 0;
}

std::set<std::string> names_of(const std::vector<ParsedSource>& all) {
  std::set<std::string> names;
  for (const ParsedSource& parsed : all) {
    for (const EnumType& e : parsed.declared.enums) names.insert(e.name);
    for (const Type& t : parsed.declared.types) names.insert(t.name);
  }
  return names;
}

}  // namespace

std::vector<ParsedSource> parse_together(std::vector<Source> sources, const Fault& fault) {
  std::vector<ParsedSource> all;
  for (Source& source : sources) {
    try {
      Declarations declared = parse_lcm(source);
      all.push_back({std::move(source), std::move(declared)});
    } catch (const SchemaError& error) {
      fault(error.what());
    }
  }
  std::map<std::string, std::string> known;
  drop(all, fault, [&](const ParsedSource& parsed) { return declared_twice(parsed, known); });
  // what is dropped may have declared what others need
  for (bool again = true; again;) {
    const std::set<std::string> names = names_of(all);
    again = drop(all, fault, [&](const ParsedSource& parsed) { return unknown_type(parsed, names); });
  }
  return all;
}

}  // namespace lab
