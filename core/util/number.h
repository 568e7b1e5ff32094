// Numbers as text, independent of the locale.
#pragma once
#include <string>

namespace lab {

/// The fewest digits that read back as the same double.
std::string number(double value);

/// At most `digits` significant digits, as printf's %g: "0.1235", "1.2e-05".
std::string rounded(double value, int digits = 4);

}  // namespace lab
