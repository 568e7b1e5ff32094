#include "tests/core/urdf/corpus.h"

#include <rbd/algorithm/aba.h>
#include <rbd/algorithm/configuration.h>
#include <rbd/algorithm/data.h>
#include <rbd/algorithm/rnea.h>

#include <fstream>
#include <map>
#include <sstream>
#include <stdexcept>

namespace rbd::urdf {
namespace {

struct Macros {
  std::map<std::string, std::string> bodies;  // by name
  std::string wrapper;                        // of the section; its @ stands for a case's text
};

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  for (size_t at = 0; (at = text.find(what, at)) != text.npos; at += by.size())
    text.replace(at, what.size(), by);
  return text;
}

// $NAME and $NAME(a b c), with $1 $2 $3 of the body replaced; what is put in is expanded as well.
std::string expand(const std::string& text, const Macros& macros) {
  std::string out;
  for (size_t i = 0; i < text.size(); ++i) {
    size_t end = i + 1;
    while (end < text.size() && std::isupper(static_cast<unsigned char>(text[end]))) ++end;
    if (text[i] != '$' || end == i + 1) {
      out += text[i];
      continue;
    }
    std::string body = macros.bodies.at(text.substr(i + 1, end - i - 1));
    if (end < text.size() && text[end] == '(') {
      const size_t close = text.find(')', end);
      std::istringstream arguments(text.substr(end + 1, close - end - 1));
      std::string argument;
      for (int k = 1; arguments >> argument; ++k) body = replaced(body, "$" + std::to_string(k), argument);
      end = close + 1;
    }
    out += expand(body, macros);
    i = end - 1;
  }
  return out;
}

// {N: text}: N times the text, in which $i counts from 0 and $k from 1. Not nested.
std::string repeat(const std::string& text) {
  std::string out = text;
  for (size_t at = 0; (at = out.find('{', at)) != out.npos;) {
    const size_t colon = out.find(':', at), close = out.find('}', at);
    if (close == out.npos || out[at + 1] < '0' || out[at + 1] > '9') {
      ++at;
      continue;
    }
    const std::string once = out.substr(colon + 1, close - colon - 1);
    std::string all;
    for (int i = 0; i < std::stoi(out.substr(at + 1)); ++i)
      all += replaced(replaced(once, "$i", std::to_string(i)), "$k", std::to_string(i + 1));
    out.replace(at, close + 1 - at, all);
    at += all.size();
  }
  return out;
}

std::string unescaped(const std::string& text) {
  return replaced(replaced(replaced(text, "\\n", "\n"), "\\0", std::string(1, '\0')), "\\xE4", "\xE4");
}

std::string trimmed(const std::string& text) {
  const size_t begin = text.find_first_not_of(' ');
  return begin == text.npos ? "" : text.substr(begin, text.find_last_not_of(' ') + 1 - begin);
}

// "error 4 joint 'j': axis is zero"; nothing between line and colon: no element.
void take_apart(CorpusCase& c) {
  if (c.wanted == "ok") {
    c.ok = true;
    c.severity = Severity::Note;
    return;
  }
  std::istringstream in(c.wanted);
  std::string severity, rest;
  in >> severity >> c.line;
  std::getline(in, rest);
  const size_t colon = rest.find(": ");
  if (!in || colon == rest.npos || (severity != "error" && severity != "warning" && severity != "note"))
    throw std::runtime_error("not an outcome: " + c.wanted);
  c.severity = severity == "error"     ? Severity::Error
               : severity == "warning" ? Severity::Warning
                                       : Severity::Note;
  c.element = trimmed(rest.substr(0, colon));
  c.message = rest.substr(colon + 2);
}

}  // namespace

std::vector<CorpusCase> read_corpus(const std::string& file) {
  std::ifstream in(file);
  if (!in) throw std::runtime_error(file + ": cannot be read");
  std::vector<CorpusCase> out;
  Macros macros;
  std::string row;
  for (int line = 1; std::getline(in, row); ++line) try {
      if (trimmed(row).empty() || row[0] == '#') continue;
      if (row.ends_with(" |")) row += ' ';  // an empty text
      const size_t first = row.find(" | ");
      if (row[0] == '$') {  // $NAME = body
        const size_t equals = row.find(" = ");
        macros.bodies[row.substr(1, equals - 1)] = row.substr(equals + 3);
      } else if (row[0] == '[') {  // [section] wrapper
        macros.wrapper = row.substr(row.find("] ") + 2);
      } else {  // name | wanted | text
        const size_t second = row.find(" | ", first + 3);
        if (first == row.npos || second == row.npos) throw std::runtime_error("needs three columns");
        CorpusCase c;
        c.name = trimmed(row.substr(0, first));
        c.wanted = trimmed(row.substr(first + 3, second - first - 3));
        c.text = unescaped(repeat(expand(replaced(macros.wrapper, "@", row.substr(second + 3)), macros)));
        take_apart(c);
        out.push_back(std::move(c));
      }
    } catch (const std::exception& e) {
      throw std::runtime_error(file + ":" + std::to_string(line) + ": " + e.what());
    }
  return out;
}

std::string evaluate(const Model& model) {
  Data data(model);
  const Eigen::VectorXd one = Eigen::VectorXd::Ones(model.nv);
  for (int k = 0; k < 3; ++k) {
    const Eigen::VectorXd q = k == 0 ? neutral(model) : randomConfiguration(model, k);
    const std::string at = " at q = " + (std::ostringstream() << q.transpose()).str();
    if (!q.allFinite()) return "q not finite" + at;
    if (!rnea(model, data, q, k * one, one).allFinite()) return "rnea not finite" + at;
    try {
      if (!aba(model, data, q, k * one, one).allFinite()) return "aba not finite" + at;
    } catch (const std::runtime_error&) {  // singular: said so
    }
  }
  return "";
}

}  // namespace rbd::urdf
