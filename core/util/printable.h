// Names and texts of others - channels, processes, robots, links, joints, folders - as people can see them: this one function
// makes what is not UTF-8, control characters and signs that turn the direction of writing visible. Text, JSON, pages and
// terminals show names through it: say() and emit() (core/util/console.h), json_text(), page::escape().
#pragma once
#include <string>
#include <string_view>

namespace lab {

/// A byte that is not UTF-8 becomes \xff; a control character \n, \t, \r or as JSON writes it, \u001b; so do marks that change the
/// direction of writing. Everything else stays, a backslash too: JSON text keeps its meaning, a text without such
/// characters its bytes.
std::string printable(std::string_view text);

/// The same for text of many lines: a line feed stays one.
std::string printable_lines(std::string_view text);

/// A name for a cell of a table or a word of a sentence: as above; '' if it is empty; the middle of one of more than 64
/// letters is left out, and the length in bytes says so.
std::string printable_name(std::string_view name);

/// The length in bytes of the UTF-8 character that begins at `at`; 0 if none does (also for surrogates and overlong forms).
size_t utf8_length(std::string_view text, size_t at);

}  // namespace lab
