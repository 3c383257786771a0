// Formats other than EXR are encoded in memory and then written atomically.
#include "host/film/picture_io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/base/read_file.h"
#include "host/film/exposure.h"
#include "host/images/decode.h"
#include "host/images/jpeg.h"
#include "host/images/png.h"
#include "host/images/radiance.h"

namespace wavepath {
namespace {

using Encode = std::vector<std::uint8_t> (*)(const DecodedImage&);

void write_encoded(const std::string& path, const DecodedImage& image, Encode encode) {
  std::vector<std::uint8_t> bytes;
  try {
    bytes = encode(image);
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
  DecodedImage image{
      .shape = {picture.width, picture.height, 3}, .bytes = {}, .words = {}, .floats = interleave(picture)};
  for (float& value : image.floats) {
    const float kept = value > 0.0f ? std::min(value, kLargest) : 0.0f;
    clamped += !(kept == value);
    value = kept;
  }
  write_encoded(path, image, encode_radiance);
  return clamped;
}

void write_display(const std::string& path, const Picture& picture, const WriteOptions& options, Encode encode) {
  const float scale = static_cast<float>(std::exp2(exposure_of(picture, options)));
  const std::array<const Channel*, 3> channels = shown_channels(picture);
  DecodedImage image{.shape = {picture.width, picture.height, 3}, .bytes = {}, .words = {}, .floats = {}};
  image.bytes.resize(3 * picture.channels[0].values.size());
  for (std::size_t i = 0; i < image.bytes.size() / 3; ++i) {
    const glm::vec3 radiance(channels[0]->values[i], channels[1]->values[i], channels[2]->values[i]);
    const glm::vec3 shown = tonemap(options.tonemap, scale * radiance);
    for (int c = 0; c < 3; ++c)
      image.bytes[3 * i + static_cast<std::size_t>(c)] =
          static_cast<std::uint8_t>(std::lround(255.0f * to_srgb(shown[c])));
  }
  write_encoded(path, image, encode);
}

// Sample `i` as radiance: linear values as they are, others decoded from sRGB.
float to_linear(const DecodedImage& image, std::size_t i) {
  static const std::array<float, 256> kLinear = [] {
    std::array<float, 256> linear;
    for (std::size_t byte = 0; byte < linear.size(); ++byte)
      linear[byte] = from_srgb(static_cast<float>(byte) * (1.0f / 255.0f));
    return linear;
  }();
  if (!image.bytes.empty()) return kLinear[image.bytes[i]];
  return image.words.empty() ? image.floats[i] : from_srgb(static_cast<float>(image.words[i]) * (1.0f / 65535.0f));
}

// Alpha is stored as it is, and colours are not yet multiplied by it.
float alpha_of(const DecodedImage& image, std::size_t i) {
  return image.bytes.empty() ? static_cast<float>(image.words[i]) * (1.0f / 65535.0f)
                             : static_cast<float>(image.bytes[i]) * (1.0f / 255.0f);
}

Picture read_encoded(const std::string& path) {
  const std::optional<std::vector<std::uint8_t>> file = read_whole_file(path);
  if (!file) throw Error(path, "cannot be read", "check the name and its permissions");
  const std::optional<FileFormat> format = file_format(*file);
  if (!format)
    throw Error(path, "is no picture of a format that can be read", "give a .exr, .hdr, .png, .jpg or .webp picture");
  DecodedImage image;
  try {
    image = decode(*format, *file, [&](const ImageShape& shape) {
      const std::uint64_t sample_bytes = *format == FileFormat::radiance ? sizeof(float) : sizeof(std::uint16_t);
      require_memory(path, "reading it", shape.pixels() * (shape.channels * sample_bytes + 3 * sizeof(float)),
                     "use a smaller picture");
    });
  } catch (const ImageError& error) {
    throw Error(path, error.what(), "check that it is a complete picture");
  }
  Picture picture{image.shape.width, image.shape.height, {}};
  const std::size_t stored = image.shape.channels;
  const bool has_alpha = stored == 2 || stored == 4;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float> values(image.shape.pixels());
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = to_linear(image, i * stored + (stored >= 3 ? c : 0));
      if (has_alpha) values[i] *= alpha_of(image, i * stored + stored - 1);
    }
    picture.channels.push_back({std::string(1, "RGB"[c]), std::move(values)});
  }
  return picture;
}

} // namespace

std::uint64_t write_picture(const std::string& path, const Picture& picture, const PictureInfo& info,
                            const WriteOptions& options) {
  const std::optional<PictureFormat> format = picture_format(path);
  if (!format) throw Error(path, "has no extension that names a picture format", "end it in .exr, .hdr, .png or .jpg");
  if (*format == PictureFormat::exr) return write_exr(path, picture, info, options.half);
  if (*format == PictureFormat::hdr) return write_hdr(path, picture);
  write_display(path, picture, options, *format == PictureFormat::png ? encode_png : encode_jpeg);
  return 0;
}

double exposure_of(const Picture& picture, const WriteOptions& options) {
  return options.exposure ? *options.exposure : auto_exposure(picture);
}

Picture read_picture(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(path, "does not exist", "check the name");
  if (picture_format(path) != PictureFormat::exr) return read_encoded(path);
  Picture picture = read_exr(path);
  if (const Channel* grey = find_channel(picture, "Y"); grey && !find_channel(picture, "R")) {
    const std::vector<float> values = grey->values;
    picture.channels = {{"R", values}, {"G", values}, {"B", values}};
  }
  if (!find_channel(picture, "R") || !find_channel(picture, "G") || !find_channel(picture, "B"))
    throw Error(path, "has no channels R, G and B", "choose a picture with colour");
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
