// Files that are whole under their final name, or not there.
#pragma once
#include <string>

namespace lab {

/// Writes a text so that the final name never holds half of it. Throws std::runtime_error "PATH: cannot be ..
/// (why)".
void write_atomically(const std::string& path, const std::string& text);

}  // namespace lab
