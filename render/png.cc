#include "render/png.h"

#include <png.h>

#include <algorithm>
#include <bit>
#include <cerrno>
#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "core/util/atomic_file.h"

namespace lab::render {
namespace {

// libpng leaves on errors by longjmp, which must not jump over C++ objects. So: all C++ objects live in the
// callers of encode() and decode(); these two only touch them through pointers and return false after a jump.
struct Job {
  std::string bytes;  // of the file
  size_t read = 0;
  char error[200] = "";
};

void on_error(png_structp png, png_const_charp text) {
  Job* job = static_cast<Job*>(png_get_error_ptr(png));
  std::snprintf(job->error, sizeof job->error, "%s", text);
  png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

void on_write(png_structp png, png_bytep data, size_t size) {
  Job* job = static_cast<Job*>(png_get_io_ptr(png));
  bool full = false;
  try {
    job->bytes.append(reinterpret_cast<const char*>(data), size);
  } catch (...) {
    full = true;  // an exception must not cross C frames
  }
  if (full) png_error(png, "out of memory");
}

void on_read(png_structp png, png_bytep data, size_t size) {
  Job* job = static_cast<Job*>(png_get_io_ptr(png));
  if (job->bytes.size() - job->read < size) png_error(png, "the file is cut short");
  std::memcpy(data, job->bytes.data() + job->read, size);
  job->read += size;
}

// What encode() writes: rows of 8-bit colours or 16-bit greys of this machine's byte order.
struct Pixels {
  int width, height, bits;
  const uint8_t* first;
  size_t size;  // of all rows together, bytes

  size_t stride() const { return size / static_cast<size_t>(height); }
};

bool encode(Job* job, const Pixels& pixels, png_text* texts, int text_count) {
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_write_struct(&png, &info);
    return false;
  }
  png_set_write_fn(png, job, on_write, nullptr);
  png_set_IHDR(png, info, pixels.width, pixels.height, pixels.bits,
               pixels.bits == 16 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  png_set_compression_level(png, 1);
  png_set_filter(png, 0, PNG_FILTER_SUB);
  if (text_count > 0) png_set_text(png, info, texts, text_count);
  png_write_info(png, info);
  if (pixels.bits == 16 && std::endian::native == std::endian::little) png_set_swap(png);
  for (int y = 0; y < pixels.height; ++y) png_write_row(png, pixels.first + y * pixels.stride());
  png_write_end(png, info);
  png_destroy_write_struct(&png, &info);
  return true;
}

bool decode(Job* job, PngFile* out) {
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, job, on_error, on_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  if (!info || setjmp(png_jmpbuf(png))) {
    png_destroy_read_struct(&png, &info, nullptr);
    return false;
  }
  png_set_user_limits(png, 32767, 32767);
  png_set_read_fn(png, job, on_read);
  png_read_info(png, info);
  png_set_expand(png);
  png_set_strip_16(png);
  png_set_strip_alpha(png);
  png_set_gray_to_rgb(png);
  const int passes = png_set_interlace_handling(png);
  png_read_update_info(png, info);
  bool fits = true;
  try {
    out->image = Image(png_get_image_width(png, info), png_get_image_height(png, info));
  } catch (...) {
    fits = false;
  }
  if (!fits || png_get_rowbytes(png, info) != static_cast<size_t>(out->image.width) * 3)
    png_error(png, "a kind of PNG that cannot be read here");
  for (int pass = 0; pass < passes; ++pass)
    for (int y = 0; y < out->image.height; ++y) png_read_row(png, out->image.at(0, y), nullptr);
  png_read_end(png, info);
  png_textp texts = nullptr;
  const int count = png_get_text(png, info, &texts, nullptr);
  try {
    for (int i = 0; i < count; ++i) out->texts.emplace_back(texts[i].key, texts[i].text ? texts[i].text : "");
  } catch (...) {
    out->texts.clear();
  }
  png_destroy_read_struct(&png, &info, nullptr);
  return true;
}

std::string reason(int error) { return std::strerror(error); }

void check(const Pixels& pixels, const PngTexts& texts) {
  const size_t bytes_each = pixels.bits == 16 ? 2 : 3;
  if (pixels.width < 1 || pixels.height < 1 || pixels.width > 32767 || pixels.height > 32767 ||
      pixels.size != static_cast<size_t>(pixels.width) * pixels.height * bytes_each)
    throw std::invalid_argument("png: a picture of " + std::to_string(pixels.width) + " x " +
                                std::to_string(pixels.height) + " with " + std::to_string(pixels.size) +
                                " bytes cannot be written");
  for (const auto& [key, value] : texts) {
    const bool printable = std::all_of(key.begin(), key.end(), [](char c) { return c >= 32 && c <= 126; });
    if (key.empty() || key.size() > 79 || !printable || key.front() == ' ' || key.back() == ' ' ||
        value.find('\0') != std::string::npos)
      throw std::invalid_argument("png: text keyword '" + key +
                                  "' must be 1 to 79 printable characters, its value " + "without NUL");
  }
}

void write(const std::string& path, const Pixels& pixels, const PngTexts& texts) {
  check(pixels, texts);
  std::vector<png_text> chunks;
  for (const auto& [key, value] : texts) {
    png_text chunk{};
    chunk.compression = PNG_TEXT_COMPRESSION_NONE;
    chunk.key = const_cast<char*>(key.c_str());  // libpng copies it
    chunk.text = const_cast<char*>(value.c_str());
    chunk.text_length = value.size();
    chunks.push_back(chunk);
  }
  Job job;
  job.bytes.reserve(pixels.size / 2);
  if (!encode(&job, pixels, chunks.data(), static_cast<int>(chunks.size())))
    throw std::runtime_error(path + ": cannot encode PNG: " + (job.error[0] ? job.error : "out of memory"));

  if (const int error = write_and_rename(path, hidden_part(path), job.bytes, false).error; error != 0)
    throw std::runtime_error(path + ": cannot write picture: " + reason(error));
}

}  // namespace

void write_png(const std::string& path, const Image& image, const PngTexts& texts) {
  write(path, {image.width, image.height, 8, image.rgb.data(), image.rgb.size()}, texts);
}

void write_png16(const std::string& path, int width, int height, const std::vector<uint16_t>& values,
                 const PngTexts& texts) {
  write(path, {width, height, 16, reinterpret_cast<const uint8_t*>(values.data()), 2 * values.size()}, texts);
}

PngFile read_png(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw std::runtime_error(path + ": cannot open: " + reason(errno));
  Job job;
  job.bytes.assign(std::istreambuf_iterator<char>(file), {});
  PngFile out;
  if (!decode(&job, &out))
    throw std::runtime_error(path + ": cannot read PNG: " + (job.error[0] ? job.error : "out of memory"));
  return out;
}

}  // namespace lab::render
