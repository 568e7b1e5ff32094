// Files that are whole under their final name, or not there: written under another name first, then renamed.
#pragma once
#include <string>
#include <string_view>

namespace lab {

/// Writes a text and syncs it to disk. Throws std::runtime_error "PATH: cannot be .. (why)".
void write_atomically(const std::string& path, const std::string& text);

/// A hidden name beside `path`: "DIR/.NAME.part".
std::string hidden_part(const std::string& path);

struct WriteOutcome {
  int error = 0;         ///< an errno; 0 = the file is there
  bool created = false;  ///< `part` could be created
};

/// Writes the bytes to `part` and renames it to `path`, on the same file system. After an error `part` is gone
/// and `path` as it was. `sync`: on disk before it has its name, which takes milliseconds.
WriteOutcome write_and_rename(const std::string& path, const std::string& part, std::string_view bytes,
                              bool sync);

}  // namespace lab
