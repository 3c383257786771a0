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

// `keeps_alpha`: the format has a channel for it. Otherwise what is transparent is black.
void write_display(const std::string& path, const Picture& picture, const WriteOptions& options, std::uint32_t bits,
                   bool keeps_alpha, Encode encode) {
  const float scale = static_cast<float>(std::exp2(exposure_of(picture, options)));
  const std::array<const Channel*, 3> channels = shown_channels(picture);
  const Channel* alpha = keeps_alpha ? alpha_of(picture) : nullptr;
  const std::uint32_t samples = alpha ? 4 : 3;
  DecodedImage image{.shape = {picture.width, picture.height, samples}, .bytes = {}, .words = {}};
  const std::size_t pixels = picture.channels[0].values.size();
  if (bits == 16)
    image.words.reserve(samples * pixels);
  else
    image.bytes.reserve(samples * pixels);
  const auto put = [&](float value) {
    if (bits == 16)
      append(image.words, value);
    else
      append(image.bytes, value);
  };
  for (std::size_t i = 0; i < pixels; ++i) {
    glm::vec3 radiance(channels[0]->values[i], channels[1]->values[i], channels[2]->values[i]);
    const float opaque = alpha ? std::clamp(alpha->values[i], 0.0f, 1.0f) : 1.0f;
    if (alpha) radiance = opaque > 0.0f ? radiance / opaque : glm::vec3(0.0f); // alpha is not multiplied in there
    const glm::vec3 shown = tonemap(options.tonemap, scale * radiance);
    for (int c = 0; c < 3; ++c) put(to_srgb(shown[c]));
    if (alpha) put(opaque);
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
    write_display(path, picture, options, options.bits, true, encode_png);
  else
    write_display(path, picture, options, 8, false, [](const DecodedImage& image) { return encode_jpeg(image); });
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

const Channel* alpha_of(const Picture& picture) {
  const Channel* alpha = find_channel(picture, "A");
  const bool opaque = !alpha || std::ranges::all_of(alpha->values, [](float a) { return a >= 1.0f; });
  return opaque ? nullptr : alpha;
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
