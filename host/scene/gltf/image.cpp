// Decodes image files through OpenImageIO.
#include "host/scene/gltf/image.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <string_view>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "host/base/error.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kMaxTexels = std::uint64_t{1} << 28; // 16384 x 16384: 1 GiB as RGBA8
constexpr const char* kRemedy = "replace the image with a sound PNG, JPEG or WebP file";

// A file name that makes OpenImageIO choose the reader by the contents; empty for formats that glTF does not have.
const char* reader_for(std::span<const std::uint8_t> file) {
  const std::string_view head(reinterpret_cast<const char*>(file.data()), std::min<std::size_t>(file.size(), 12));
  if (head.starts_with("\x89PNG\r\n\x1a\n")) return "image.png";
  if (head.starts_with("\xff\xd8\xff")) return "image.jpg";
  if (head.starts_with("RIFF") && head.ends_with("WEBP")) return "image.webp";
  return "";
}

std::uint32_t big_endian(const std::uint8_t* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | bytes[3];
}

std::uint32_t crc32(std::span<const std::uint8_t> bytes) {
  static const std::array<std::uint32_t, 256> kTable = [] {
    std::array<std::uint32_t, 256> table;
    for (std::uint32_t i = 0; i < 256; ++i) {
      table[i] = i;
      for (int bit = 0; bit < 8; ++bit) table[i] = table[i] >> 1 ^ (table[i] & 1 ? 0xedb88320u : 0u);
    }
    return table;
  }();
  std::uint32_t crc = 0xffffffffu;
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ kTable[(crc ^ byte) & 0xff];
  return ~crc;
}

// Whether all chunks of a PNG are complete. libpng checks this too, but prints to stderr.
bool is_png_whole(std::span<const std::uint8_t> file) {
  for (std::size_t at = 8; file.size() - at >= 12;) {
    const std::uint32_t length = big_endian(&file[at]);
    if (length > file.size() - at - 12) return false;
    if (crc32(file.subspan(at + 4, std::size_t{length} + 4)) != big_endian(&file[at + 8 + length])) return false;
    if (std::memcmp(&file[at + 4], "IEND", 4) == 0) return true;
    at += std::size_t{length} + 12;
  }
  return false;
}

std::string describe(std::span<const std::uint8_t> file) {
  const std::string_view head(reinterpret_cast<const char*>(file.data()), std::min<std::size_t>(file.size(), 12));
  if (head.starts_with("\xabKTX 20\xbb")) return "is KTX2 (KHR_texture_basisu), which wavepath does not support";
  return "is neither PNG nor JPEG nor WebP";
}

// Spreads 1 (grey), 2 (grey, alpha) or 3 channels in the first texels of `texels` over 4, from the last one backwards.
template <typename T>
void spread(std::vector<T>& texels, std::size_t count, int channels, T opaque) {
  for (std::size_t i = count; channels < 4 && i-- > 0;) {
    T in[4];
    std::memcpy(in, &texels[i * static_cast<std::size_t>(channels)], sizeof(T) * static_cast<std::size_t>(channels));
    const bool grey = channels < 3;
    T* out = &texels[i * 4];
    out[0] = in[0];
    out[1] = grey ? in[0] : in[1];
    out[2] = grey ? in[0] : in[2];
    out[3] = channels == 2 ? in[1] : opaque;
  }
}

// The WebP reader of OpenImageIO before 2.5 always multiplies by alpha; this divides by it again, to the precision of 8
// bits.
void unpremultiply(std::vector<std::uint8_t>& texels) {
  for (std::size_t i = 0; i < texels.size(); i += 4) {
    const unsigned alpha = texels[i + 3];
    for (std::size_t c = 0; c < 3 && alpha > 0; ++c) {
      texels[i + c] = static_cast<std::uint8_t>(std::min((texels[i + c] * 255u + alpha / 2) / alpha, 255u));
    }
  }
}

template <typename T>
bool read_texels(OIIO::ImageInput& input, int channels, OIIO::TypeDesc type, std::size_t count, std::vector<T>& texels,
                 T opaque) {
  texels.resize(count * 4);
  if (!input.read_image(0, 0, 0, channels, type, texels.data())) return false;
  spread(texels, count, channels, opaque);
  return true;
}

} // namespace

Image decode_image(const std::string& where, const std::string& name, std::span<const std::uint8_t> file) {
  const std::string what = "image '" + name + "' ";
  const std::string reader = reader_for(file);
  if (reader.empty()) throw Error(where, what + describe(file), kRemedy);
  if (reader == "image.png" && !is_png_whole(file)) throw Error(where, what + "is damaged or cut short", kRemedy);
  OIIO::Filesystem::IOMemReader memory(const_cast<std::uint8_t*>(file.data()), file.size()); // only read from
  OIIO::Filesystem::IOProxy* proxy = &memory;
  OIIO::ImageSpec config;
  config["oiio:UnassociatedAlpha"] = 1;
  config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &proxy);
  auto input = OIIO::ImageInput::open(reader, &config);
  const auto damaged = [&] {
    std::string problem = input ? input->geterror() : OIIO::geterror();
    problem = problem.substr(0, problem.find('\n'));
    return Error(where, what + "cannot be decoded" + (problem.empty() ? "" : ": " + problem), kRemedy);
  };
  if (!input) throw damaged();

  const OIIO::ImageSpec& spec = input->spec();
  const std::uint64_t count = spec.image_pixels();
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels < 1) throw Error(where, what + "is empty", kRemedy);
  if (count > kMaxTexels) {
    throw Error(where, what + "has " + std::to_string(spec.width) + " x " + std::to_string(spec.height) + " texels",
                "scale it down to at most 16384 x 16384");
  }
  Image image;
  image.name = name;
  image.width = static_cast<std::uint32_t>(spec.width);
  image.height = static_cast<std::uint32_t>(spec.height);
  const int channels = std::min(spec.nchannels, 4);
  const bool read = spec.format.size() > 1
                        ? read_texels(*input, channels, OIIO::TypeDesc::FLOAT, count, image.floats, 1.0f)
                        : read_texels(*input, channels, OIIO::TypeDesc::UINT8, count, image.bytes, std::uint8_t{255});
  if (!read) throw damaged();
  const bool keeps_alpha_apart = reader != "image.webp" || spec.get_int_attribute("oiio:UnassociatedAlpha") != 0;
  if (!keeps_alpha_apart) unpremultiply(image.bytes);
  return image;
}

} // namespace wavepath
