// An 8-bit RGB picture: row 0 is the top row, three bytes a pixel, rows packed without padding.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lab::render {

struct Image {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;  // width * height * 3 bytes

  Image() = default;
  Image(int w, int h) : width(w), height(h), rgb(static_cast<size_t>(w) * h * 3) {}
  uint8_t* at(int x, int y) { return rgb.data() + (static_cast<size_t>(y) * width + x) * 3; }
  const uint8_t* at(int x, int y) const { return rgb.data() + (static_cast<size_t>(y) * width + x) * 3; }
};

// What a camera measures, one value per pixel, at the pixel's exact centre: no anti-aliasing. Rows from the top.
struct Measurement {
  int width = 0, height = 0;
  std::vector<float> depth;  // metres along the view direction; infinity where nothing is seen
  std::vector<uint16_t> id;  // Part::id of what is seen; 0 = floor or nothing

  size_t at(int x, int y) const { return static_cast<size_t>(y) * width + x; }
};

// Depth as whole numbers of `unit` metres, rounded: 0 where nothing is seen or it does not fit (0.001:
// millimetres, up to 65.535 m). For write_png16.
std::vector<uint16_t> quantized(const std::vector<float>& depth, double unit = 0.001);

// Writes `text` with its top left corner at (x, y), in a built-in 5x7 bitmap font enlarged `scale` times;
// clipped at the edges. One character is 6 * scale wide and 9 * scale high, of which 2 hang below the line. Characters
// that the font lacks are drawn as a box.
void draw_text(Image& image, int x, int y, const std::string& text, int scale, const uint8_t (&colour)[3]);

// The picture made smaller by a whole factor: averages of factor x factor pixels; what is left over at the
// right and lower edge is dropped. Throws std::invalid_argument if nothing would be left.
Image shrink(const Image& image, int factor);

// One picture of many: cells in rows of `columns`, each as large as the largest image, a caption below each
// one. labels: one for each image, or none at all. columns 0 = about as wide as high. Throws
// std::invalid_argument if there is no image, a count differs, or the sheet would be unreasonably large.
Image contact_sheet(const std::vector<Image>& images, const std::vector<std::string>& labels,
                    int columns = 0);

}  // namespace lab::render
