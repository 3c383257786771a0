// PNG by libpng, from and to memory; its errors leave by longjmp, its warnings are dropped.
#include "host/codecs/png.h"

#include <bit>
#include <cstring>
#include <new>
#include <string>

#include <png.h>
#include <zlib.h>

#include "host/codecs/long_jump.h"

namespace wavepath {
namespace {

void fail(png_structp png, png_const_charp words) { static_cast<LongJump*>(png_get_error_ptr(png))->leave(words); }
void ignore(png_structp, png_const_charp) {}

// Chunks that libpng knows and nobody here asks for, so that it does not unpack them: a profile of a few bytes may
// unpack to megabytes, and a malformed one must not spoil sound pixels. Four letters and a zero each.
constexpr png_byte kPassedOver[] =
    "bKGD\0cHRM\0eXIf\0gAMA\0hIST\0iCCP\0iTXt\0oFFs\0pCAL\0"
    "pHYs\0sBIT\0sCAL\0sPLT\0sRGB\0tEXt\0tIME\0zTXt";

struct Reader {
  explicit Reader(std::span<const std::uint8_t> file) : rest(file) {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &jump, fail, ignore);
    info = png ? png_create_info_struct(png) : nullptr;
    if (!info) {
      png_destroy_read_struct(&png, &info, nullptr);
      throw std::bad_alloc();
    }
    png_set_read_fn(png, &rest, read);
  }
  ~Reader() { png_destroy_read_struct(&png, &info, nullptr); }
  Reader(Reader&&) = delete;

  static void read(png_structp png, png_bytep out, std::size_t bytes) {
    auto& rest = *static_cast<std::span<const std::uint8_t>*>(png_get_io_ptr(png));
    if (bytes > rest.size()) png_error(png, "the file ends early");
    std::memcpy(out, rest.data(), bytes);
    rest = rest.subspan(bytes);
  }

  std::span<const std::uint8_t> rest;
  LongJump jump;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

struct Writer {
  Writer() {
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &jump, fail, ignore);
    info = png ? png_create_info_struct(png) : nullptr;
    if (!info) {
      png_destroy_write_struct(&png, &info);
      throw std::bad_alloc();
    }
    png_set_write_fn(png, this, write, nullptr);
  }
  ~Writer() { png_destroy_write_struct(&png, &info); }
  Writer(Writer&&) = delete;

  // Memory that runs out must not unwind through libpng.
  static void write(png_structp png, png_bytep data, std::size_t bytes) {
    if (!static_cast<Writer*>(png_get_io_ptr(png))->append(data, bytes)) png_error(png, "out of memory");
  }
  bool append(const std::uint8_t* data, std::size_t bytes) try {
    file.insert(file.end(), data, data + bytes);
    return true;
  } catch (const std::bad_alloc&) {
    return false;
  }

  std::vector<std::uint8_t> file;
  LongJump jump;
  png_structp png = nullptr;
  png_infop info = nullptr;
};

// PNG stores the high byte first.
constexpr bool kSwapWords = std::endian::native == std::endian::little;

template <class Sample>
std::vector<png_bytep> row_pointers(Sample* samples, const ImageShape& shape) {
  std::vector<png_bytep> rows(shape.height);
  for (std::size_t y = 0; y < rows.size(); ++y)
    rows[y] = reinterpret_cast<png_bytep>(samples + y * shape.width * shape.channels);
  return rows;
}

} // namespace

DecodedImage decode_png(std::span<const std::uint8_t> file, const CheckShape& check) {
  Reader reader(file);
  DecodedImage image;
  ImageShape& shape = image.shape;
  bool deep = false;
  decode_step(reader.jump, [&] {
    png_set_keep_unknown_chunks(reader.png, PNG_HANDLE_CHUNK_NEVER, kPassedOver, sizeof kPassedOver / 5);
    png_set_crc_action(reader.png, PNG_CRC_ERROR_QUIT, PNG_CRC_ERROR_QUIT);
    png_read_info(reader.png, reader.info);
    const int color = png_get_color_type(reader.png, reader.info);
    const bool alpha = (color & PNG_COLOR_MASK_ALPHA) || png_get_valid(reader.png, reader.info, PNG_INFO_tRNS);
    shape = {png_get_image_width(reader.png, reader.info), png_get_image_height(reader.png, reader.info),
             (color & PNG_COLOR_MASK_COLOR ? 3u : 1u) + alpha};
    deep = png_get_bit_depth(reader.png, reader.info) == 16;
  });
  check(shape);

  std::vector<png_bytep> rows =
      deep ? row_pointers(reserve(image.words, shape), shape) : row_pointers(reserve(image.bytes, shape), shape);
  decode_step(reader.jump, [&] {
    png_set_expand(reader.png);
    if (deep && kSwapWords) png_set_swap(reader.png);
    png_set_interlace_handling(reader.png);
    png_read_update_info(reader.png, reader.info);
    if (png_get_rowbytes(reader.png, reader.info) != std::size_t{shape.width} * shape.channels * (deep ? 2 : 1))
      png_error(reader.png, "rows of unforeseen length");
    png_read_image(reader.png, rows.data());
    png_read_end(reader.png, nullptr);
  });
  return image;
}

std::vector<std::uint8_t> encode_png(const DecodedImage& image) {
  constexpr int kColor[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGBA};
  const ImageShape& shape = image.shape;
  const bool deep = !image.words.empty();
  // libpng takes pointers to non-const for reading and writing alike.
  std::vector<png_bytep> rows = deep ? row_pointers(const_cast<std::uint16_t*>(image.words.data()), shape)
                                     : row_pointers(const_cast<std::uint8_t*>(image.bytes.data()), shape);
  Writer writer;
  const bool written = completes(writer.jump, [&] {
    // Runs alone, not repetitions further apart, which pictures hardly have: 0.2 to 0.4 of the time of zlib's default
    // strategy, and 1.00 to 1.04 of its bytes (three renders, noisy and denoised; level 1 was slower and larger).
    png_set_compression_strategy(writer.png, Z_RLE);
    png_set_IHDR(writer.png, writer.info, shape.width, shape.height, deep ? 16 : 8, kColor[shape.channels - 1],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(writer.png, writer.info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(writer.png, writer.info);
    if (deep && kSwapWords) png_set_swap(writer.png);
    png_write_image(writer.png, rows.data());
    png_write_end(writer.png, nullptr);
  });
  if (!written) throw ImageError("cannot be encoded (" + std::string(writer.jump.words) + ")");
  return std::move(writer.file);
}

} // namespace wavepath
