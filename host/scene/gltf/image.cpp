// Decodes the images of glTF files and spreads them over four channels.
#include "host/scene/gltf/image.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "host/base/error.h"
#include "host/codecs/decode.h"
#include "ktx/container.h"
#include "ktx/error.h"
#include "ktx/read.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kMaxTexels = std::uint64_t{1} << 28; // 16384 x 16384: 1 GiB as RGBA8
constexpr const char* kRemedy = "replace the image with a sound PNG, JPEG, WebP or KTX2 file";

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

// Words of 0 to 65535 as floats of 0 to 1.
void widen(const std::vector<std::uint16_t>& words, std::vector<float>& floats) {
  floats.reserve(words.size());
  for (const std::uint16_t word : words) floats.push_back(static_cast<float>(word) * (1.0f / 65535.0f));
}

// Colours as shading can bear them: finite and at least 0. Returns the number of those that were not.
std::uint64_t repair_values(std::vector<float>& values) {
  constexpr float kMost = 65504.0f; // of a half: radiance beyond it is a mistake
  std::uint64_t count = 0;
  for (float& value : values) {
    const float sound = value >= 0.0f ? std::min(value, kMost) : 0.0f;
    if (!(sound == value)) ++count;
    value = sound;
  }
  return count;
}

TextureImage take_ktx2(std::span<const std::uint8_t> file, const ktx::CheckSize& check) {
  ktx::Picture picture = ktx::read(file, check);
  TextureImage result{{}, picture.transfer, picture.premultiplied};
  result.image.width = picture.width;
  result.image.height = picture.height;
  result.image.bytes = std::move(picture.bytes);
  result.image.floats = std::move(picture.floats);
  result.holds_values = !result.image.floats.empty();
  if (result.holds_values) result.bad_values = repair_values(result.image.floats);
  if (!picture.words.empty()) widen(picture.words, result.image.floats);
  return result;
}

TextureImage take_picture(FileFormat format, std::span<const std::uint8_t> file, const CheckShape& check) {
  DecodedImage decoded = decode(format, file, check);
  TextureImage result;
  result.image.width = decoded.shape.width;
  result.image.height = decoded.shape.height;
  if (decoded.words.empty()) {
    spread(decoded.bytes, decoded.shape, std::uint8_t{255});
    result.image.bytes = std::move(decoded.bytes);
  } else {
    result.image.floats.reserve(decoded.shape.pixels() * 4);
    widen(decoded.words, result.image.floats);
    spread(result.image.floats, decoded.shape, 1.0f);
  }
  return result;
}

} // namespace

TextureImage decode_image(const std::string& where, const std::string& name, std::span<const std::uint8_t> file) {
  const std::string what = "image '" + name + "' ";
  const auto check = [&](const ImageShape& shape) {
    if (shape.pixels() > kMaxTexels)
      throw Error(where, what + "has " + std::to_string(shape.width) + " x " + std::to_string(shape.height) + " texels",
                  "scale it down to at most 16384 x 16384");
  };
  TextureImage result;
  try {
    if (ktx::is_ktx2(file)) {
      result = take_ktx2(file, [&](std::uint32_t width, std::uint32_t height) { check({width, height, 4}); });
    } else {
      const std::optional<FileFormat> format = file_format(file);
      if (!format) throw ImageError("is neither PNG nor JPEG nor WebP nor KTX2");
      result = take_picture(*format, file, check);
    }
  } catch (const ImageError& error) {
    throw Error(where, what + error.what(), kRemedy);
  } catch (const ktx::FileError& error) {
    throw Error(where, what + error.what(), kRemedy);
  }
  result.image.name = name;
  return result;
}

} // namespace wavepath
