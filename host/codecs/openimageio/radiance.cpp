// OpenImageIO's own writer cuts mantissas off, which would darken pictures by a fifth of a percent on average. So it is
// given the middle of the interval of each mantissa that is meant, which no rounding on its way can move out of it.
#include "host/codecs/openimageio/radiance.h"

#include <algorithm>
#include <cmath>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "host/codecs/image.h"

namespace wavepath {
namespace {

// The exponent that a pixel is stored with: its brightest channel is below 2^exponent once it is rounded.
int stored_exponent(float brightest) {
  int exponent = 0;
  const float mantissa = std::frexp(brightest, &exponent);
  return std::round(256.0f * mantissa) == 256.0f ? exponent + 1 : exponent;
}

void to_middles(float* rgb) {
  const float brightest = std::max({rgb[0], rgb[1], rgb[2]});
  const int exponent = stored_exponent(brightest);
  const bool black = !(brightest > 0.0f) || exponent < -127;
  for (std::size_t c = 0; c < 3; ++c) {
    const float mantissa = black ? 0.0f : std::round(std::ldexp(rgb[c], 8 - exponent));
    rgb[c] = mantissa > 0.0f ? std::ldexp(mantissa + 0.5f, exponent - 8) : 0.0f;
  }
}

[[noreturn]] void fail(const std::string& words) { throw ImageError("cannot be encoded (" + words + ")"); }

} // namespace

std::vector<std::uint8_t> encode_radiance_by_openimageio(std::uint32_t width, std::uint32_t height,
                                                         const std::vector<float>& rgb) {
  std::vector<float> middles = rgb;
  for (std::size_t i = 0; i + 2 < middles.size(); i += 3) to_middles(&middles[i]);
  OIIO::Filesystem::IOVecOutput bytes;
  const auto output = OIIO::ImageOutput::create("hdr");
  if (!output || !output->set_ioproxy(&bytes)) fail("this OpenImageIO writes no Radiance files");
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("Software", "wavepath");
  if (!output->open("picture.hdr", spec) || !output->write_image(OIIO::TypeDesc::FLOAT, middles.data()) ||
      !output->close())
    fail(output->geterror());
  return bytes.buffer();
}

} // namespace wavepath
