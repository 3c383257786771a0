// Formats other than EXR are encoded in memory and then written atomically.
#include "host/picture/files/picture_io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <utility>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/codecs/jpeg.h"
#include "host/codecs/linear_picture.h"
#include "host/codecs/picture_module.h"
#include "host/codecs/png.h"
#include "host/picture/exposure.h"

namespace wavepath {
namespace {

using Encode = std::vector<std::uint8_t> (*)(const DecodedImage&);

void write_encoded(const std::string& path, const std::function<std::vector<std::uint8_t>()>& encode) {
  std::vector<std::uint8_t> bytes;
  try {
    bytes = encode();
  } catch (const ImageError& error) {
    throw Error(path, error.what(), "choose another size or format");
  }
  AtomicFile file(path);
  file.write(bytes.data(), bytes.size());
  file.commit();
}

std::vector<float> interleave(const Picture& picture) {
  const std::array<const Channel*, 3> shown = shown_channels(picture);
  std::vector<float> rgb(3 * picture.channels[0].values.size());
  for (std::size_t i = 0; i < rgb.size(); ++i) rgb[i] = shown[i % 3]->values[i / 3];
  return rgb;
}

// The format ends at 2^127 and has no negative values.
std::uint64_t write_hdr(const std::string& path, const Picture& picture) {
  constexpr float kLargest = 1.6e38f;
  std::uint64_t clamped = 0;
  std::vector<float> rgb = interleave(picture);
  for (float& value : rgb) {
    const float kept = value > 0.0f ? std::min(value, kLargest) : 0.0f;
    clamped += !(kept == value);
    value = kept;
  }
  write_encoded(path, [&] { return picture_module(path).encode_radiance(picture.width, picture.height, rgb); });
  return clamped;
}

// Appends the value in [0,1] as a whole number of the sample's range.
template <class Sample>
void append(std::vector<Sample>& samples, float value) {
  samples.push_back(static_cast<Sample>(std::lround(static_cast<float>(std::numeric_limits<Sample>::max()) * value)));
}

void write_display(const std::string& path, const Picture& picture, const WriteOptions& options, std::uint32_t bits,
                   Encode encode) {
  const float scale = static_cast<float>(std::exp2(exposure_of(picture, options)));
  const std::array<const Channel*, 3> channels = shown_channels(picture);
  DecodedImage image{.shape = {picture.width, picture.height, 3}, .bytes = {}, .words = {}};
  const std::size_t pixels = picture.channels[0].values.size();
  if (bits == 16)
    image.words.reserve(3 * pixels);
  else
    image.bytes.reserve(3 * pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const glm::vec3 radiance(channels[0]->values[i], channels[1]->values[i], channels[2]->values[i]);
    const glm::vec3 shown = tonemap(options.tonemap, scale * radiance);
    for (int c = 0; c < 3; ++c)
      if (bits == 16)
        append(image.words, to_srgb(shown[c]));
      else
        append(image.bytes, to_srgb(shown[c]));
  }
  write_encoded(path, [&] { return encode(image); });
}

} // namespace

std::uint64_t write_picture(const std::string& path, const Picture& picture, const PictureInfo& info,
                            const WriteOptions& options) {
  const std::optional<PictureFormat> format = picture_format(path);
  if (!format) throw Error(path, "has no extension that names a picture format", "end it in .exr, .hdr, .png or .jpg");
  if (*format == PictureFormat::exr) return write_exr(path, picture, info, options);
  if (*format == PictureFormat::hdr) return write_hdr(path, picture);
  if (*format == PictureFormat::png)
    write_display(path, picture, options, options.bits, encode_png);
  else
    write_display(path, picture, options, 8, encode_jpeg);
  return 0;
}

double exposure_of(const Picture& picture, const WriteOptions& options) {
  return options.exposure ? *options.exposure : auto_exposure(picture);
}

Picture read_picture(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(path, "does not exist", "check the name");
  if (std::optional<Picture> own = read_own_exr(path)) return *std::move(own);
  LinearPicture stored =
      read_linear(path, {.wanted = [](const std::string& channel) { return !channel.starts_with(kFilmPrefix); }});
  Picture picture{stored.width, stored.height, {}, stored.display};
  for (std::size_t i = 0; i < stored.planes.size(); ++i)
    picture.channels.push_back({stored.channels[i], std::move(stored.planes[i])});
  return picture;
}

Picture read_light(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(path, "does not exist", "check the name");
  LinearPicture stored = read_linear(path, {.light = true, .wanted = {}, .check = {}});
  Picture picture{stored.width, stored.height, {}};
  for (std::size_t i = 0; i < stored.planes.size(); ++i)
    picture.channels.push_back({stored.channels[i], std::move(stored.planes[i])});
  return picture;
}

std::array<const Channel*, 3> shown_channels(const Picture& picture) {
  std::array<const Channel*, 3> channels{};
  for (std::size_t c = 0; c < 3; ++c) {
    const Channel* filtered = find_channel(picture, std::string(kShownPrefix) + "RGB"[c]);
    channels[c] = filtered ? filtered : &picture.channels[c];
  }
  return channels;
}

Picture shown_picture(const Picture& picture) {
  Picture shown{picture.width, picture.height, {}};
  for (std::size_t c = 0; c < 3; ++c)
    shown.channels.push_back({std::string(1, "RGB"[c]), shown_channels(picture)[c]->values});
  return shown;
}

const Channel* find_channel(const Picture& picture, const std::string& name) {
  const auto found =
      std::find_if(picture.channels.begin(), picture.channels.end(), [&](const Channel& c) { return c.name == name; });
  return found == picture.channels.end() ? nullptr : &*found;
}

} // namespace wavepath
