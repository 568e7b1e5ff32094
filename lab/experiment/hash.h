// XXH3, 64 bits: not cryptographic; identifies texts and files.
#pragma once
#include <cstdint>
#include <string>
#include <string_view>

namespace lab {

int64_t hash_of(std::string_view text);
/// Of a file's bytes; 0 if it cannot be read.
int64_t hash_of_file(const std::string& path);
/// Sixteen hexadecimal digits.
std::string hex(int64_t hash);

}  // namespace lab
