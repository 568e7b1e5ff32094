// A 5x7 bitmap font for captions, drawn for this project: printable ASCII, 32 to 126. Rows from the top, the last
// two below the line; bit 4 of a row is its leftmost pixel.
#pragma once

#include <cstdint>

namespace lab::render {

inline constexpr int kGlyphRows = 9;
extern const uint8_t kFont[95][kGlyphRows];

}  // namespace lab::render
