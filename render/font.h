// A 5x7 bitmap font for captions, drawn for this project: printable ASCII, 32 to 126. Seven rows a glyph from
// the top; bit 4 of a row is its leftmost pixel.
#pragma once

#include <cstdint>

namespace lab::render {

extern const uint8_t kFont[95][7];

}  // namespace lab::render
