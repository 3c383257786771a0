// Formats other than EXR by OpenImageIO, encoded in memory and then written atomically.
#include "host/film/picture_io.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/film/exposure.h"

namespace wavepath {
namespace {

// Encodes interleaved RGB to the bytes of a file whose format the extension of `path` names.
template <class T>
void write_encoded(const std::string& path, const Picture& picture, OIIO::TypeDesc type, const std::vector<T>& rgb) {
  OIIO::ImageSpec spec(static_cast<int>(picture.width), static_cast<int>(picture.height), 3, type);
  spec.attribute("oiio:ColorSpace", type == OIIO::TypeDesc::UINT8 ? "sRGB" : "Linear");
  if (picture_format(path) == PictureFormat::jpg) {
    spec.attribute("Compression", "jpeg:95");
    spec.attribute("jpeg:subsampling", "4:4:4"); // colours at full resolution
  }

  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const auto output = OIIO::ImageOutput::create(path);
  const bool encoded = output && output->set_ioproxy(&memory) && output->open(path, spec) &&
                       output->write_image(type, rgb.data()) && output->close();
  if (!encoded)
    throw Error(path, fmt::format("OpenImageIO cannot encode it ({})", output ? output->geterror() : OIIO::geterror()),
                "choose another size or format");
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

// Rounds a colour to what shared-exponent bytes hold: 8 bits of the brightest channel. The encoder truncates, which
// would darken the picture by a fifth of a percent on average.
glm::vec3 round_to_shared_exponent(glm::vec3 color) {
  int exponent = 0;
  const float mantissa = std::frexp(std::max({color.x, color.y, color.z}), &exponent);
  if (std::round(256.0f * mantissa) == 256.0f) ++exponent; // rounds up to the next power of two
  for (int c = 0; c < 3; ++c) color[c] = std::ldexp(std::round(std::ldexp(color[c], 8 - exponent)), exponent - 8);
  return color;
}

// The format ends at 2^127 and has no negative values.
std::uint64_t write_hdr(const std::string& path, const Picture& picture) {
  constexpr float kLargest = 1.6e38f;
  std::uint64_t clamped = 0;
  std::vector<float> rgb = interleave(picture);
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    glm::vec3 kept;
    for (int c = 0; c < 3; ++c) {
      const float value = rgb[i + static_cast<std::size_t>(c)];
      kept[c] = value > 0.0f ? std::min(value, kLargest) : 0.0f;
      clamped += !(kept[c] == value);
    }
    kept = round_to_shared_exponent(kept);
    for (int c = 0; c < 3; ++c) rgb[i + static_cast<std::size_t>(c)] = kept[c];
  }
  write_encoded(path, picture, OIIO::TypeDesc::FLOAT, rgb);
  return clamped;
}

void write_display(const std::string& path, const Picture& picture, const WriteOptions& options) {
  const float scale = static_cast<float>(std::exp2(exposure_of(picture, options)));
  const std::array<const Channel*, 3> channels = shown_channels(picture);
  std::vector<std::uint8_t> rgb(3 * picture.channels[0].values.size());
  for (std::size_t i = 0; i < rgb.size() / 3; ++i) {
    const glm::vec3 radiance(channels[0]->values[i], channels[1]->values[i], channels[2]->values[i]);
    const glm::vec3 shown = tonemap(options.tonemap, scale * radiance);
    for (int c = 0; c < 3; ++c)
      rgb[3 * i + static_cast<std::size_t>(c)] = static_cast<std::uint8_t>(std::lround(255.0f * to_srgb(shown[c])));
  }
  write_encoded(path, picture, OIIO::TypeDesc::UINT8, rgb);
}

Picture read_encoded(const std::string& path) {
  const auto input = OIIO::ImageInput::open(path);
  if (!input)
    throw Error(path, fmt::format("cannot be read ({})", OIIO::geterror()), "check that it is a complete picture");
  const OIIO::ImageSpec& spec = input->spec();
  Picture picture;
  picture.width = static_cast<std::uint32_t>(spec.width);
  picture.height = static_cast<std::uint32_t>(spec.height);
  const std::size_t pixel_count = static_cast<std::size_t>(picture.width) * picture.height;
  const std::size_t stored = static_cast<std::size_t>(spec.nchannels);
  require_memory(path, "reading it", pixel_count * (stored + 3) * sizeof(float), "use a smaller picture");

  std::vector<float> values(pixel_count * stored);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values.data()))
    throw Error(path, fmt::format("cannot be decoded ({})", input->geterror()), "check that it is a complete picture");
  const bool encoded = !spec.format.is_floating_point();
  for (std::size_t c = 0; c < 3; ++c) {
    Channel& channel =
        picture.channels.emplace_back(Channel{std::string(1, "RGB"[c]), std::vector<float>(pixel_count)});
    const std::size_t source = stored >= 3 ? c : 0;
    for (std::size_t i = 0; i < pixel_count; ++i) {
      const float value = values[i * stored + source];
      channel.values[i] = encoded ? from_srgb(value) : value;
    }
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
  write_display(path, picture, options);
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
