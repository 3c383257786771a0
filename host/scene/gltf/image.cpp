// Decodes the images of glTF files and spreads them over four channels.
#include "host/scene/gltf/image.h"

#include <algorithm>
#include <cstring>
#include <string_view>

#include "host/base/error.h"
#include "host/codecs/decode.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kMaxTexels = std::uint64_t{1} << 28; // 16384 x 16384: 1 GiB as RGBA8
constexpr const char* kRemedy = "replace the image with a sound PNG, JPEG or WebP file";

std::string describe(std::span<const std::uint8_t> file) {
  const std::string_view head(reinterpret_cast<const char*>(file.data()), std::min<std::size_t>(file.size(), 12));
  if (head.starts_with("\xabKTX 20\xbb")) return "is KTX2 (KHR_texture_basisu), which wavepath does not support";
  return "is neither PNG nor JPEG nor WebP";
}

// Spreads 1 (grey), 2 (grey, alpha) or 3 channels over 4 where they lie, from the last texel backwards.
template <typename T>
void spread(std::vector<T>& texels, const ImageShape& shape, T opaque) {
  const std::size_t channels = shape.channels;
  texels.resize(shape.pixels() * 4);
  for (std::size_t i = shape.pixels(); channels < 4 && i-- > 0;) {
    T in[4];
    std::memcpy(in, &texels[i * channels], sizeof(T) * channels);
    const bool grey = channels < 3;
    T* out = &texels[i * 4];
    out[0] = in[0];
    out[1] = grey ? in[0] : in[1];
    out[2] = grey ? in[0] : in[2];
    out[3] = channels == 2 ? in[1] : opaque;
  }
}

} // namespace

Image decode_image(const std::string& where, const std::string& name, std::span<const std::uint8_t> file) {
  const std::string what = "image '" + name + "' ";
  const std::optional<FileFormat> format = file_format(file);
  if (!format) throw Error(where, what + describe(file), kRemedy);
  const auto check = [&](const ImageShape& shape) {
    if (shape.pixels() > kMaxTexels)
      throw Error(where, what + "has " + std::to_string(shape.width) + " x " + std::to_string(shape.height) + " texels",
                  "scale it down to at most 16384 x 16384");
  };
  DecodedImage decoded;
  try {
    decoded = decode(*format, file, check);
  } catch (const ImageError& error) {
    throw Error(where, what + error.what(), kRemedy);
  }

  Image image;
  image.name = name;
  image.width = decoded.shape.width;
  image.height = decoded.shape.height;
  if (decoded.words.empty()) {
    spread(decoded.bytes, decoded.shape, std::uint8_t{255});
    image.bytes = std::move(decoded.bytes);
  } else {
    image.floats.reserve(decoded.shape.pixels() * 4);
    for (const std::uint16_t word : decoded.words) image.floats.push_back(static_cast<float>(word) * (1.0f / 65535.0f));
    spread(image.floats, decoded.shape, 1.0f);
  }
  return image;
}

} // namespace wavepath
