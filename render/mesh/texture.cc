#include "render/mesh/texture.h"

#include <jpeglib.h>
#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <stdexcept>

namespace lab::render {
namespace {

constexpr int kMaxSide = 8192;

void make_room(Texture& out, unsigned width, unsigned height) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    throw std::runtime_error("a picture of " + std::to_string(width) + " x " + std::to_string(height) +
                             " pixels is not taken (1 to " + std::to_string(kMaxSide) + " a side)");
  out.width = static_cast<int>(width);
  out.height = static_cast<int>(height);
  out.rgba.resize(size_t{width} * height * 4);
}

void decode_png(const std::string& bytes, Texture& out) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  const auto fail = [&] {
    const std::string why = image.message;
    png_image_free(&image);
    throw std::runtime_error("broken PNG: " + why);
  };
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size())) fail();
  image.format = PNG_FORMAT_RGBA;
  try {
    make_room(out, image.width, image.height);
  } catch (...) {
    png_image_free(&image);
    throw;
  }
  if (!png_image_finish_read(&image, nullptr, out.rgba.data(), 0, nullptr)) fail();
}

// libjpeg reports errors by a function that must not return.
struct Jpeg {
  jpeg_decompress_struct info{};
  jpeg_error_mgr errors{};
  std::jmp_buf jump{};
  char message[JMSG_LENGTH_MAX] = {};
};

void on_error(j_common_ptr info) {
  Jpeg& jpeg = *static_cast<Jpeg*>(info->client_data);
  info->err->format_message(info, jpeg.message);
  std::longjmp(jpeg.jump, 1);
}

// Between setjmp and longjmp nothing with a destructor is made; rows go straight into the texture.
bool read_jpeg_head(Jpeg& jpeg, const std::string& bytes) {
  jpeg.info.err = jpeg_std_error(&jpeg.errors);
  jpeg.errors.error_exit = on_error;
  jpeg.errors.output_message = [](j_common_ptr) {};
  if (setjmp(jpeg.jump)) return false;
  jpeg.info.client_data = &jpeg;
  jpeg_create_decompress(&jpeg.info);
  jpeg_mem_src(&jpeg.info, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  jpeg_read_header(&jpeg.info, TRUE);
  return true;
}

bool read_jpeg_rows(Jpeg& jpeg, Texture& out) {
  if (setjmp(jpeg.jump)) return false;
  jpeg.info.out_color_space = JCS_EXT_RGBA;
  jpeg_start_decompress(&jpeg.info);
  while (jpeg.info.output_scanline < jpeg.info.output_height) {
    JSAMPROW row = out.rgba.data() + size_t{jpeg.info.output_scanline} * out.width * 4;
    jpeg_read_scanlines(&jpeg.info, &row, 1);
  }
  jpeg_finish_decompress(&jpeg.info);
  return jpeg.errors.num_warnings == 0;  // cut data is only a warning to libjpeg
}

void decode_jpeg(const std::string& bytes, Texture& out) {
  Jpeg jpeg;
  struct Guard {
    Jpeg& jpeg;
    ~Guard() { jpeg_destroy_decompress(&jpeg.info); }
  } guard{jpeg};
  const auto fail = [&] {
    throw std::runtime_error(std::string("broken JPEG: ") +
                             (jpeg.message[0] ? jpeg.message : "cut or damaged data"));
  };
  if (!read_jpeg_head(jpeg, bytes)) fail();
  make_room(out, jpeg.info.image_width, jpeg.info.image_height);
  if (!read_jpeg_rows(jpeg, out)) fail();
}

}  // namespace

std::shared_ptr<const Texture> decode_texture(const std::string& bytes) {
  auto out = std::make_shared<Texture>();
  if (bytes.compare(0, 4, "\x89PNG") == 0) {
    decode_png(bytes, *out);
  } else if (bytes.compare(0, 3, "\xff\xd8\xff") == 0) {
    decode_jpeg(bytes, *out);
  } else {
    throw std::runtime_error("neither PNG nor JPEG");
  }
  out->file = bytes;
  return out;
}

}  // namespace lab::render
