#include "render/image.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>

#include "render/font.h"

namespace lab::render {

std::vector<uint16_t> quantized(const std::vector<float>& depth, double unit) {
  if (!(unit > 0) || !std::isfinite(unit))
    throw std::invalid_argument("quantized: the unit must be positive and finite");
  std::vector<uint16_t> out;
  out.reserve(depth.size());
  for (float metres : depth) {
    const double units = std::round(metres / unit);
    out.push_back(units >= 0 && units <= 65535 ? static_cast<uint16_t>(units) : 0);
  }
  return out;
}

void draw_text(Image& image, int x, int y, const std::string& text, int scale, const uint8_t (&colour)[3]) {
  for (size_t i = 0; i < text.size(); ++i) {
    const int code = static_cast<unsigned char>(text[i]);
    for (int row = 0; row < kGlyphRows * scale; ++row) {
      for (int column = 0; column < 5 * scale; ++column) {
        const int gy = row / scale, gx = column / scale;
        const bool frame = gy < 7 && (gy == 0 || gy == 6 || gx == 0 || gx == 4);
        const bool ink = code >= 32 && code <= 126 ? (kFont[code - 32][gy] >> (4 - gx)) & 1 : frame;
        const int px = x + static_cast<int>(i) * 6 * scale + column, py = y + row;
        if (ink && px >= 0 && py >= 0 && px < image.width && py < image.height)
          std::copy(colour, colour + 3, image.at(px, py));
      }
    }
  }
}

Image shrink(const Image& image, int factor) {
  if (factor < 1 || image.width / std::max(factor, 1) < 1 || image.height / std::max(factor, 1) < 1)
    throw std::invalid_argument("shrink: factor " + std::to_string(factor) +
                                " leaves nothing of the picture");
  Image out(image.width / factor, image.height / factor);
  const unsigned n = static_cast<unsigned>(factor) * factor;
  for (int y = 0; y < out.height; ++y) {
    for (int x = 0; x < out.width; ++x) {
      unsigned sum[3] = {0, 0, 0};
      for (int dy = 0; dy < factor; ++dy) {
        const uint8_t* p = image.at(x * factor, y * factor + dy);
        for (int k = 0; k < 3 * factor; ++k) sum[k % 3] += p[k];
      }
      for (int c = 0; c < 3; ++c) out.at(x, y)[c] = static_cast<uint8_t>((sum[c] + n / 2) / n);
    }
  }
  return out;
}

Image contact_sheet(const std::vector<Image>& images, const std::vector<std::string>& labels, int columns) {
  if (images.empty()) throw std::invalid_argument("contact sheet: no pictures");
  if (!labels.empty() && labels.size() != images.size())
    throw std::invalid_argument("contact sheet: " + std::to_string(images.size()) + " pictures but " +
                                std::to_string(labels.size()) + " labels");
  const int count = static_cast<int>(images.size());
  if (columns < 0) throw std::invalid_argument("contact sheet: columns must not be negative");
  if (columns == 0) columns = static_cast<int>(std::ceil(std::sqrt(count)));
  columns = std::min(columns, count);
  const int rows = (count + columns - 1) / columns;

  int cell_width = 0, cell_height = 0;
  for (const Image& image : images) {
    if (image.rgb.size() != static_cast<size_t>(image.width) * image.height * 3)
      throw std::invalid_argument("contact sheet: a picture's bytes do not match its size");
    cell_width = std::max(cell_width, image.width);
    cell_height = std::max(cell_height, image.height);
  }
  // a sheet is seen smaller than it is, on a page or a phone, so its captions are large
  const int scale = std::max(1, cell_width / 100), gap = 4 * scale;
  const int caption = labels.empty() ? 0 : kGlyphRows * scale + gap;
  const int64_t width = gap + static_cast<int64_t>(columns) * (cell_width + gap);
  const int64_t height = gap + static_cast<int64_t>(rows) * (cell_height + caption + gap);
  if (width > 32767 || height > 32767 || width * height > 200'000'000)
    throw std::invalid_argument("contact sheet: " + std::to_string(width) + " x " + std::to_string(height) +
                                " pixels are too many; take fewer or smaller pictures");

  Image sheet(static_cast<int>(width), static_cast<int>(height));
  std::fill(sheet.rgb.begin(), sheet.rgb.end(), 250);
  constexpr uint8_t kInk[3] = {60, 64, 70};
  for (int i = 0; i < count; ++i) {
    const int x = gap + i % columns * (cell_width + gap),
              y = gap + i / columns * (cell_height + caption + gap);
    for (int row = 0; row < images[i].height; ++row)
      std::memcpy(sheet.at(x, y + row), images[i].at(0, row), static_cast<size_t>(images[i].width) * 3);
    if (labels.empty()) continue;
    // A caption never runs into the next cell.
    const std::string label = labels[i].substr(0, std::max(1, (cell_width + scale) / (6 * scale)));
    draw_text(sheet, x, y + cell_height + gap, label, scale, kInk);
  }
  return sheet;
}

}  // namespace lab::render
