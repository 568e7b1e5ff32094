// Words for a command line that a POSIX shell reads.
#pragma once
#include <string>

namespace lab {

/// The word as the shell reads it back: as it is if no character in it is special, else in single quotes.
std::string shell_quote(const std::string& word);

}  // namespace lab
