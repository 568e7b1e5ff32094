// PNG files, 8-bit RGB, through libpng: compression level 1 with filter Sub (measured fastest and smaller
// than the default's result at this level on rendered pictures).
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "render/image.h"

namespace lab::render {

using PngTexts =
    std::vector<std::pair<std::string, std::string>>;  // keyword (1-79 Latin-1 characters), value

// Writes the picture and its tEXt chunks. Atomic for readers: the bytes go to `.NAME.part` in the same
// folder, which takes the final name only when all of them are written (not synced: a power cut may still
// lose the file), and is removed on any failure. Throws std::runtime_error with path and reason (unwritable,
// disk full); std::invalid_argument for an empty or inconsistent image or a text that PNG cannot hold.
void write_png(const std::string& path, const Image& image, const PngTexts& texts = {});

// The same for one 16-bit grey value a pixel: depths and ids.
void write_png16(const std::string& path, int width, int height, const std::vector<uint16_t>& values,
                 const PngTexts& texts = {});

struct PngFile {
  Image image;
  PngTexts texts;
};

// Reads any PNG as 8-bit RGB (alpha dropped). Throws std::runtime_error with path and reason.
PngFile read_png(const std::string& path);

}  // namespace lab::render
