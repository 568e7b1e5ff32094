// Which version this is.
#pragma once
#include <string>

namespace lab {

inline constexpr const char* kVersion = LAB_VERSION;

/// The commit that was built, "-dirty" if files differed from it; "unknown" outside a repository.
std::string commit();

}  // namespace lab
