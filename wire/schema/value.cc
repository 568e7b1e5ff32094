#include "wire/schema/value.h"

#include <charconv>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/util/json_text.h"

namespace lab {
namespace {

template <class T>
std::string number_text(T x) {
  char s[64];
  const auto [end, error] = std::to_chars(s, s + sizeof s, x);
  return std::string(s, end);
}

bool is_compound(const Value& v) { return v.is.index() >= 5; }

void scalar(std::string& out, const Value& v) {
  if (const auto* b = std::get_if<bool>(&v.is)) out += *b ? "true" : "false";
  if (const auto* i = std::get_if<int64_t>(&v.is)) out += std::to_string(*i);
  if (const auto* f = std::get_if<float>(&v.is)) out += number_text(*f);
  if (const auto* d = std::get_if<double>(&v.is)) out += number_text(*d);
  if (const auto* s = std::get_if<std::string>(&v.is)) {
    out += json_text(nlohmann::json(*s));
  }
}

void print(std::string& out, const std::string& name, const Value& v, int indent) {
  const std::string pad(indent, ' ');
  const auto* array = std::get_if<Value::Array>(&v.is);
  if (const auto* members = std::get_if<Value::Struct>(&v.is)) {
    if (!name.empty()) out += pad + name + ":\n";
    for (const Member& m : *members) print(out, m.name, m.value, indent + (name.empty() ? 0 : 2));
  } else if (array && !array->empty() && is_compound(array->front())) {
    for (size_t i = 0; i < array->size(); ++i)
      print(out, name + "[" + std::to_string(i) + "]", (*array)[i], indent);
  } else if (array) {
    out += pad + name + ": [";
    for (size_t i = 0; i < array->size(); ++i) {
      if (i > 0) out += ", ";
      scalar(out, (*array)[i]);
    }
    out += "]\n";
  } else {
    out += pad + name + ": ";
    scalar(out, v);
    out += "\n";
  }
}

}  // namespace

const Value* Value::at(std::string_view path) const {
  if (path.empty()) return this;
  if (path[0] == '[') {
    const auto* array = std::get_if<Array>(&is);
    size_t index = 0;
    const auto [end, error] = std::from_chars(path.data() + 1, path.data() + path.size(), index);
    if (!array || error != std::errc() || end == path.data() + path.size() || *end != ']' ||
        index >= array->size()) {
      return nullptr;
    }
    return (*array)[index].at(path.substr(static_cast<size_t>(end + 1 - path.data())));
  }
  if (path[0] == '.') path.remove_prefix(1);
  const size_t n = std::min(path.find_first_of(".["), path.size());
  if (const auto* members = std::get_if<Struct>(&is)) {
    for (const Member& m : *members) {
      if (m.name == path.substr(0, n)) return m.value.at(path.substr(n));
    }
  }
  return nullptr;
}

double Value::number() const {
  if (const auto* b = std::get_if<bool>(&is)) return *b;
  if (const auto* i = std::get_if<int64_t>(&is)) return static_cast<double>(*i);
  if (const auto* f = std::get_if<float>(&is)) return *f;
  if (const auto* d = std::get_if<double>(&is)) return *d;
  return std::numeric_limits<double>::quiet_NaN();
}

std::string to_text(const Value& value) {
  std::string out;
  print(out, "", value, 0);
  return out;
}

nlohmann::ordered_json to_json(const Value& value) {
  using Json = nlohmann::ordered_json;
  if (const auto* members = std::get_if<Value::Struct>(&value.is)) {
    Json out = Json::object();
    for (const Member& m : *members) out[m.name] = to_json(m.value);
    return out;
  }
  if (const auto* array = std::get_if<Value::Array>(&value.is)) {
    Json out = Json::array();
    for (const Value& v : *array) out.push_back(to_json(v));
    return out;
  }
  if (const auto* s = std::get_if<std::string>(&value.is)) {
    return *s;
  }
  if (const auto* b = std::get_if<bool>(&value.is)) return *b;
  if (const auto* i = std::get_if<int64_t>(&value.is)) return *i;
  const auto finite = [](auto x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  if (const auto* f = std::get_if<float>(&value.is)) return finite(*f);
  return finite(std::get<double>(value.is));
}

}  // namespace lab
