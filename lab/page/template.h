// Templates of pages: a subset of Mustache (mustache.github.io) over JSON.
//
//   {{name}}                      the value, escaped for HTML; text, whole numbers and booleans only
//   {{{name}}}                    the value as it is: HTML that was made by a template or a plot
//   {{.}}                         the item itself, in a list of plain values
//   {{#name}}..{{/name}}          once per item of a list, once with the members of an object, once if true; else nothing
//   {{^name}}..{{/name}}          if the list is empty, the value is false, null or "", or there is none
//   {{>file}}                     another template, filled in the same way
//
// Names are looked up in the innermost object that has them. A tag of a section or a {{>file}} alone on its line takes
// the line with it.
#pragma once
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace lab::page {

/// Texts by file name; embed_texts() of CMake makes a function that returns them.
using Texts = std::map<std::string, std::string_view, std::less<>>;

/// Text for HTML and SVG; hidden characters are made visible (core/util/printable.h).
std::string escape(std::string_view text);

/// texts[file], filled. Throws std::logic_error for a template that is wrong: a name without value, an open section.
std::string fill(const Texts& texts, std::string_view file, const nlohmann::json& values);

}  // namespace lab::page
