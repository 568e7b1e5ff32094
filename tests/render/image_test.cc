#include "render/image.h"

#include <gtest/gtest.h>

#include <set>

#include "render/font.h"

namespace lab::render {
namespace {

Image plain(int width, int height, uint8_t value) {
  Image image(width, height);
  std::fill(image.rgb.begin(), image.rgb.end(), value);
  return image;
}

int count(const Image& image, uint8_t value) {
  int n = 0;
  for (size_t i = 0; i < image.rgb.size(); i += 3) n += image.rgb[i] == value;
  return n;
}

TEST(Image, FontHasDifferentGlyphsWithInk) {
  std::set<std::vector<uint8_t>> glyphs;
  for (int c = 1; c < 95; ++c) {  // after the space
    const std::vector<uint8_t> glyph(kFont[c], kFont[c] + kGlyphRows);
    EXPECT_TRUE(glyphs.insert(glyph).second) << "same as another: " << static_cast<char>(c + 32);
    EXPECT_NE(glyph, std::vector<uint8_t>(kGlyphRows, 0));
    for (uint8_t row : glyph) EXPECT_LT(row, 32);
  }
}

TEST(Image, TextIsScaledAndClipped) {
  constexpr uint8_t ink[3] = {9, 9, 9};
  Image one = plain(40, 20, 200), three = plain(120, 60, 200);
  draw_text(one, 2, 3, "1.5 s", 1, ink);
  draw_text(three, 6, 9, "1.5 s", 3, ink);
  EXPECT_GT(count(one, 9), 20);
  EXPECT_EQ(count(three, 9), 9 * count(one, 9));
  EXPECT_EQ(shrink(three, 3).rgb, one.rgb);
  draw_text(one, -3, -3, "corner\xff", 2, ink);  // must not write outside (sanitizers watch)
  draw_text(one, 35, 18, "corner", 2, ink);
}

TEST(Image, ShrinkAverages) {
  Image image(4, 3);
  for (int i = 0; i < 36; ++i) image.rgb[i] = static_cast<uint8_t>(i);
  const Image half = shrink(image, 2);
  ASSERT_EQ(half.width, 2);
  ASSERT_EQ(half.height, 1);  // the odd last row is dropped
  EXPECT_EQ(half.rgb[0], (0 + 3 + 12 + 15 + 2) / 4);
  EXPECT_EQ(half.rgb[5], (8 + 11 + 20 + 23 + 2) / 4);
  EXPECT_THROW(shrink(image, 0), std::invalid_argument);
  EXPECT_THROW(shrink(image, 4), std::invalid_argument);
}

TEST(Image, ContactSheetHoldsEveryPictureOnce) {
  std::vector<Image> images;
  std::vector<std::string> labels;
  for (int i = 0; i < 7; ++i) {
    images.push_back(plain(32 + i % 2, 24, static_cast<uint8_t>(i + 1)));
    labels.push_back(std::to_string(i) + ".25 s");
  }
  for (int columns : {0, 1, 3, 7, 50}) {
    const Image sheet = contact_sheet(images, labels, columns);
    for (int i = 0; i < 7; ++i) EXPECT_EQ(count(sheet, static_cast<uint8_t>(i + 1)), images[i].width * 24);
  }
  // 3 columns of 33 pixels, 3 rows of 24 and a caption of 9 + 4; gaps of 4 at this size
  const Image sheet = contact_sheet(images, labels, 3);
  EXPECT_EQ(sheet.width, 4 + 3 * (33 + 4));
  EXPECT_EQ(sheet.height, 4 + 3 * (24 + 13 + 4));
  EXPECT_EQ(contact_sheet(images, {}, 3).height, 4 + 3 * (24 + 4));
  // captions: ink in the band below the first picture, none without labels
  EXPECT_GT(count(sheet, 60), 100);
  EXPECT_EQ(count(contact_sheet(images, {}, 3), 60), 0);
}

TEST(Image, ContactSheetRefusesNonsense) {
  const std::vector<Image> two(2, plain(8, 8, 1));
  EXPECT_THROW(contact_sheet({}, {}, 1), std::invalid_argument);
  EXPECT_THROW(contact_sheet(two, {"one"}, 1), std::invalid_argument);
  EXPECT_THROW(contact_sheet(two, {}, -1), std::invalid_argument);
  EXPECT_THROW(contact_sheet(std::vector<Image>(10, plain(4000, 10, 1)), {}, 10), std::invalid_argument);
}

}  // namespace
}  // namespace lab::render
