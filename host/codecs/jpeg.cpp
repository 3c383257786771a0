// JPEG by libjpeg, from and to memory; its errors, and warnings of damage, leave by longjmp, it prints nothing.
#include "host/codecs/jpeg.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <jpeglib.h>

#include <jerror.h> // after the configuration that jpeglib.h reads: it decides which messages there are

#include "host/codecs/long_jump.h"

namespace wavepath {
namespace {

// Limit of the scans of a progressive file. Encoders make about ten; a small file of thousands would keep the decoder
// busy for hours.
constexpr int kMostScans = 500;

// Callbacks of libjpeg. `errors` comes first, so that its address is that of the whole struct.
struct Callbacks {
  Callbacks() {
    jpeg_std_error(&errors);
    errors.error_exit = leave;
    errors.emit_message = [](j_common_ptr codec, int) {
      if (of(codec).means_damage()) leave(codec);
    };
    errors.output_message = [](j_common_ptr) {};
    progress.progress_monitor = [](j_common_ptr codec) {
      if (!codec->is_decompressor || reinterpret_cast<j_decompress_ptr>(codec)->input_scan_number <= kMostScans) return;
      of(codec).jump.leave("it has more than 500 scans");
    };
  }
  Callbacks(Callbacks&&) = delete;

  static Callbacks& of(j_common_ptr codec) { return *reinterpret_cast<Callbacks*>(codec->err); }
  static void leave(j_common_ptr codec) {
    char words[JMSG_LENGTH_MAX];
    codec->err->format_message(codec, words);
    of(codec).jump.leave(words);
  }

  // True if the current warning says that pixels are missing or wrong; others are about oddities besides them. The end
  // mark may be missing if there is one scan, which itself tells whether it is complete.
  bool means_damage() const {
    const int code = errors.msg_code;
    return code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE || code == JWRN_ARITH_BAD_CODE ||
           code == JWRN_MUST_RESYNC || code == JWRN_BOGUS_PROGRESSION || (code == JWRN_JPEG_EOF && several_scans);
  }

  jpeg_error_mgr errors{};
  jpeg_progress_mgr progress{};
  bool several_scans = false;
  LongJump jump;
};

// A jpeg_decompress_struct or jpeg_compress_struct. It is zero until it is created, and destroying that is allowed.
template <class Codec>
struct Owner {
  Owner() { codec.err = &callbacks.errors; }
  ~Owner() { jpeg_destroy(reinterpret_cast<j_common_ptr>(&codec)); }
  Owner(Owner&&) = delete;

  Callbacks callbacks;
  Codec codec{};
};

// Multiplies inks by black, both inverted, to the nearest of 255 steps.
void to_rgb(const std::uint8_t* cmyk, std::size_t count, std::uint8_t* rgb) {
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t c = 0; c < 3; ++c)
      rgb[3 * i + c] = static_cast<std::uint8_t>((cmyk[4 * i + c] * cmyk[4 * i + 3] + 127) / 255);
}

} // namespace

DecodedImage decode_jpeg(std::span<const std::uint8_t> file, const CheckShape& check) {
  Owner<jpeg_decompress_struct> owner;
  jpeg_decompress_struct& codec = owner.codec;
  LongJump& jump = owner.callbacks.jump;
  DecodedImage image;
  ImageShape& shape = image.shape;
  decode_step(jump, [&] {
    jpeg_create_decompress(&codec);
    codec.progress = &owner.callbacks.progress;
    jpeg_mem_src(&codec, const_cast<std::uint8_t*>(file.data()), file.size()); // only read from
    jpeg_read_header(&codec, TRUE);
    owner.callbacks.several_scans = jpeg_has_multiple_scans(&codec);
    const bool inks = codec.jpeg_color_space == JCS_CMYK || codec.jpeg_color_space == JCS_YCCK;
    const bool grey = codec.jpeg_color_space == JCS_GRAYSCALE;
    codec.out_color_space = inks ? JCS_CMYK : grey ? JCS_GRAYSCALE : JCS_RGB;
    shape = {codec.image_width, codec.image_height, grey ? 1u : 3u};
  });
  check(shape);

  std::uint8_t* out = reserve(image.bytes, shape);
  const bool inks = codec.out_color_space == JCS_CMYK;
  std::vector<std::uint8_t> cmyk(inks ? std::size_t{shape.width} * 4 : 0);
  const std::size_t row_bytes = std::size_t{shape.width} * shape.channels;
  decode_step(jump, [&] {
    jpeg_start_decompress(&codec);
    while (codec.output_scanline < shape.height) {
      JSAMPROW rows[4]; // libjpeg makes up to four at a time
      std::uint8_t* first = out + codec.output_scanline * row_bytes;
      const unsigned wanted = inks ? 1 : std::min(4u, shape.height - codec.output_scanline);
      for (unsigned i = 0; i < wanted; ++i) rows[i] = inks ? cmyk.data() : first + i * row_bytes;
      jpeg_read_scanlines(&codec, rows, wanted);
      if (inks) to_rgb(cmyk.data(), shape.width, first);
    }
  });
  return image;
}

std::vector<std::uint8_t> encode_jpeg(const DecodedImage& image, const JpegOptions& options) {
  Owner<jpeg_compress_struct> owner;
  jpeg_compress_struct& codec = owner.codec;
  struct Output { // grown by libjpeg with malloc
    unsigned char* data = nullptr;
    unsigned long bytes = 0;
    ~Output() { std::free(data); }
  } output;
  const bool written = completes(owner.callbacks.jump, [&] {
    jpeg_create_compress(&codec);
    jpeg_mem_dest(&codec, &output.data, &output.bytes);
    codec.image_width = image.shape.width;
    codec.image_height = image.shape.height;
    codec.input_components = static_cast<int>(image.shape.channels);
    codec.in_color_space = image.shape.channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg_set_defaults(&codec);
    jpeg_set_quality(&codec, options.quality, TRUE);
    for (int c = 0; c < codec.num_components; ++c)
      codec.comp_info[c].h_samp_factor = codec.comp_info[c].v_samp_factor = c == 0 && options.halves_colours ? 2 : 1;
    jpeg_start_compress(&codec, TRUE);
    const std::size_t row_bytes = std::size_t{image.shape.width} * image.shape.channels;
    while (codec.next_scanline < codec.image_height) {
      JSAMPROW row = const_cast<std::uint8_t*>(image.bytes.data()) + codec.next_scanline * row_bytes; // only read from
      jpeg_write_scanlines(&codec, &row, 1);
    }
    jpeg_finish_compress(&codec);
  });
  if (!written) throw ImageError("cannot be encoded (" + std::string(owner.callbacks.jump.words) + ")");
  return {output.data, output.data + output.bytes};
}

} // namespace wavepath
