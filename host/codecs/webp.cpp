#include "host/codecs/webp.h"

#include <webp/decode.h>

namespace wavepath {

DecodedImage decode_webp(std::span<const std::uint8_t> file, const CheckShape& check) {
  WebPBitstreamFeatures features{};
  if (WebPGetFeatures(file.data(), file.size(), &features) != VP8_STATUS_OK)
    throw ImageError("is damaged or cut short (no sound WebP header)");
  if (features.has_animation) throw ImageError("is an animation");
  DecodedImage image;
  image.shape = {static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height),
                 features.has_alpha ? 4u : 3u};
  check(image.shape);

  std::uint8_t* out = reserve(image.bytes, image.shape);
  const auto decode = features.has_alpha ? WebPDecodeRGBAInto : WebPDecodeRGBInto;
  const int row_bytes = features.width * static_cast<int>(image.shape.channels); // at most 2^14 * 4
  if (!decode(file.data(), file.size(), out, image.bytes.size(), row_bytes))
    throw ImageError("is damaged or cut short (libwebp cannot decode it)");
  return image;
}

} // namespace wavepath
