#include "host/serve/frame.h"

#include <bit>
#include <vector>

#include "host/codecs/image.h"
#include "host/codecs/jpeg.h"
#include "host/codecs/png.h"

namespace wavepath {
namespace {

// For pictures in motion, whose colours nobody has time to look at, and for those that stand still.
constexpr JpegOptions kInMotion{.quality = 80, .halves_colours = true}, kStanding{.quality = 92};

template <class T>
void append(std::string& bytes, T value) {
  for (std::size_t i = 0; i < sizeof value; ++i) bytes += static_cast<char>(value >> 8 * i & 0xff);
}

} // namespace

std::string bytes_of(const FrameHeader& header) {
  std::string bytes;
  append(bytes, header.number);
  append(bytes, header.count);
  append(bytes, header.spp);
  append(bytes, header.coarse);
  append(bytes, static_cast<std::uint16_t>(header.format));
  append(bytes, header.done);
  append(bytes, header.width);
  append(bytes, header.height);
  append(bytes, std::bit_cast<std::uint32_t>(header.error));
  append(bytes, std::bit_cast<std::uint32_t>(header.seconds));
  return bytes;
}

std::string encode_screen(std::span<const std::uint32_t> screen, std::uint32_t width, std::uint32_t height,
                          FrameQuality quality) {
  DecodedImage image;
  image.shape = {width, height, 3};
  image.bytes.resize(image.shape.pixels() * 3);
  std::uint8_t* to = image.bytes.data();
  for (const std::uint32_t word : screen)
    for (int c = 0; c < 3; ++c) *to++ = static_cast<std::uint8_t>(word >> 8 * c);
  const std::vector<std::uint8_t> file =
      quality == FrameQuality::exact ? encode_png(image)
                                     : encode_jpeg(image, quality == FrameQuality::motion ? kInMotion : kStanding);
  return {file.begin(), file.end()};
}

} // namespace wavepath
