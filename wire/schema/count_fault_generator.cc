// Build step: reads .lcm files and writes count_fault for each of their messages, lab/count_fault.hpp and
// count_fault.cc.
#include <cstdio>
#include <fstream>
#include <iterator>
#include <set>
#include <string>

#include "wire/schema/schema_parse.h"

namespace {

using lab::Dim;
using lab::Field;
using lab::Kind;
using lab::Type;

std::string file_text(const std::string& path) {
  std::ifstream in(path);
  if (!in) throw std::runtime_error(path + ": cannot be read");
  return {std::istreambuf_iterator<char>(in), {}};
}

/// lab.robot_state_t -> `between` in place of dots.
std::string name_with(std::string name, const std::string& between) {
  for (size_t at; (at = name.find('.')) != std::string::npos;) name.replace(at, 1, between);
  return name;
}

/// The statement that checks one member; empty when its size cannot be wrong.
std::string check(const Type& type, const Field& field, const std::set<std::string>& enums) {
  std::string lengths;
  bool counted = false;
  for (const Dim& dim : field.dims) {
    const bool by_member = dim.member >= 0;
    counted |= by_member;
    lengths += lengths.empty() ? "" : ", ";
    lengths +=
        by_member ? "{\"" + dim.text + "\", m." + dim.text + "}" : "{\"\", " + std::to_string(dim.size) + "}";
  }
  if (!counted && (field.kind != Kind::Struct || enums.contains(field.type_name))) return "";
  return "  if (std::string fault = lab::length_fault(\"" + type.name + "\", \"" + field.name + "\", m." +
         field.name + ", {" + lengths + "}); !fault.empty()) return fault;\n";
}

void write(const std::string& path, const std::string& text) {
  std::ofstream out(path);
  out << text;
  if (!out.flush()) throw std::runtime_error(path + ": cannot be written");
}

int generate(const std::string& folder, const std::vector<std::string>& files) {
  std::vector<Type> types;
  std::set<std::string> enums;
  for (const std::string& file : files) {
    lab::Declarations found = lab::parse_lcm({file, file_text(file)});
    for (const auto& e : found.enums) enums.insert(e.name);
    for (Type& type : found.types) types.push_back(std::move(type));
  }
  std::string header = "// Made by count_fault_generator.\n#pragma once\n#include <string>\n";
  std::string source = "// Made by count_fault_generator.\n#include \"lab/count_fault.hpp\"\n";
  std::string bodies;
  for (const Type& type : types) {
    const size_t dot = type.name.rfind('.');
    const std::string space = name_with(type.name.substr(0, dot), "::"), name = type.name.substr(dot + 1);
    const std::string signature = "std::string count_fault(const " + name + "& m)";
    header += "namespace " + space + " {\nclass " + name + ";\n" + signature + ";\n}\n";
    source += "#include <" + name_with(type.name, "/") + ".hpp>\n";
    std::string checks;
    for (const Field& field : type.fields) checks += check(type, field, enums);
    bodies += "namespace " + space + " {\n" + signature + " {\n" +
              (checks.empty() ? "  static_cast<void>(m);\n" : checks) + "  return {};\n}\n}\n";
  }
  write(folder + "/lab/count_fault.hpp", header);
  write(folder + "/count_fault.cc", source + "#include \"wire/schema/length_fault.h\"\n" + bodies);
  return 0;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc < 3) {
    std::fprintf(stderr, "usage: %s FOLDER FILE.lcm ..\n", argv[0]);
    return 2;
  }
  return generate(argv[1], {argv + 2, argv + argc});
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
