// PNG, JPEG and WebP by the decoders of textures, everything else by the module.
#include "host/codecs/linear_picture.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <numeric>
#include <optional>
#include <utility>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/base/read_file.h"
#include "host/codecs/colour_channels.h"
#include "host/codecs/cube_map.h"
#include "host/codecs/decode.h"
#include "host/codecs/picture_module.h"
#include "host/codecs/primaries.h"
#include "host/codecs/srgb.h"
#include "host/codecs/stored_format.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 36; // so that byte counts cannot overflow
constexpr const char* kColourNames[] = {"R", "G", "B"};

void check_pixels(const std::string& path, const ReadRequest& request, std::uint32_t width, std::uint32_t height,
                  std::uint64_t pixel_bytes) {
  const std::uint64_t pixels = std::uint64_t{width} * height;
  if (pixels > kMostPixels) throw Error(path, "claims more pixels than can be read", "check that it is intact");
  if (request.check) request.check(width, height);
  require_memory(path, "reading it", pixels * pixel_bytes, "use a smaller picture");
}

// --- decoders of textures ---

float decoded(const DecodedImage& image, std::size_t i) {
  static const std::vector<float> kLinear = [] {
    std::vector<float> linear;
    for (int byte = 0; byte < 256; ++byte)
      linear.push_back(static_cast<float>(linear_from_srgb(static_cast<double>(static_cast<float>(byte) / 255.0f))));
    return linear;
  }();
  if (!image.bytes.empty()) return kLinear[image.bytes[i]];
  return static_cast<float>(linear_from_srgb(static_cast<double>(static_cast<float>(image.words[i]) / 65535.0f)));
}

// Alpha is stored as it is, and colours are not yet multiplied by it.
float alpha_at(const DecodedImage& image, std::size_t i) {
  return image.bytes.empty() ? static_cast<float>(image.words[i]) / 65535.0f
                             : static_cast<float>(image.bytes[i]) / 255.0f;
}

LinearPicture read_decoded(const std::string& path, const ReadRequest& request) {
  const std::optional<std::vector<std::uint8_t>> file = read_whole_file(path);
  const std::optional<FileFormat> format = file ? file_format(*file) : std::nullopt;
  if (!format) throw Error(path, "cannot be read", "check the name and its permissions");
  const DecodedImage image = decode(*format, *file, [&](const ImageShape& shape) {
    check_pixels(path, request, shape.width, shape.height, shape.channels * sizeof(std::uint16_t) + 3 * sizeof(float));
  });
  LinearPicture picture{.width = image.shape.width, .height = image.shape.height, .channels = {}, .planes = {}};
  picture.display = true;
  const std::size_t stored = image.shape.channels;
  const bool has_alpha = stored == 2 || stored == 4;
  for (std::size_t c = 0; c < 3; ++c) {
    std::vector<float> values(image.shape.pixels());
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] = decoded(image, i * stored + (stored >= 3 ? c : 0));
      if (has_alpha) values[i] *= alpha_at(image, i * stored + stored - 1);
    }
    picture.channels.emplace_back(kColourNames[c]);
    picture.planes.push_back(std::move(values));
  }
  return picture;
}

// --- the module ---

// The part and channels of a file that were chosen.
struct Stored {
  StoredPart part;
  ColourChannels colours;
  std::vector<std::size_t> channels; // that were read, in this order
  std::vector<std::vector<float>> planes;

  std::size_t index_of(std::size_t channel) const {
    return static_cast<std::size_t>(std::ranges::find(channels, channel) - channels.begin());
  }
};

void refuse_windows(const std::string& path, const StoredPart& part) {
  const bool covered =
      part.x <= 0 && part.y <= 0 && part.x + part.width >= part.full_width && part.y + part.height >= part.full_height;
  if (!covered)
    throw Error(path,
                "has a data window (" + std::to_string(part.width) + " x " + std::to_string(part.height) +
                    ") that differs from its display window",
                "save the environment uncropped");
}

StoredChoice choose(const std::string& path, const ReadRequest& request, const std::vector<StoredPart>& parts,
                    Stored& stored) {
  const std::optional<ColourChannels> found = colour_channels(parts);
  if (!found)
    throw Error(path, "has no R, G and B channels (it has " + channel_list(parts) + ")", "save it as an RGB image");
  stored.colours = *found;
  stored.part = parts[found->part];
  const StoredPart& part = stored.part;
  if (part.deep) throw Error(path, "is a deep image, with several samples per pixel", "save it flattened");
  if (part.full_width == 0 || part.full_height == 0) throw ImageError("has an empty display window");
  if (request.environment) refuse_windows(path, part);
  if (request.light && part.cube && !(request.environment && is_stacked_cube(part.width, part.height)))
    throw Error(path, "is a cube map whose faces are not stacked as in OpenEXR", "save it as a lat-long image");
  std::vector<bool> takes(part.channels.size());
  for (const std::size_t channel : found->rgb) takes[channel] = true;
  if (part.unassociated_alpha) takes.at(*part.unassociated_alpha) = true;
  for (std::size_t i = 0; i < takes.size(); ++i)
    takes[i] = takes[i] || (request.wanted && request.wanted(part.channels[i]));
  for (std::size_t i = 0; i < takes.size(); ++i)
    if (takes[i]) stored.channels.push_back(i);
  const std::uint64_t bytes = (stored.channels.size() + 3) * sizeof(float);
  check_pixels(path, request, part.width, part.height, bytes);
  check_pixels(path, request, part.full_width, part.full_height, bytes);
  return {found->part, stored.channels};
}

// The plane within the display window; zeros where nothing is stored.
std::vector<float> in_display_window(const StoredPart& part, std::vector<float> plane) {
  if (part.x == 0 && part.y == 0 && part.width == part.full_width && part.height == part.full_height) return plane;
  std::vector<float> shown(std::size_t{part.full_width} * part.full_height);
  const std::int64_t left = std::max<std::int64_t>(part.x, 0), top = std::max<std::int64_t>(part.y, 0),
                     right = std::min<std::int64_t>(part.x + part.width, part.full_width),
                     bottom = std::min<std::int64_t>(part.y + part.height, part.full_height);
  for (std::int64_t y = top; y < bottom && left < right; ++y)
    std::copy_n(plane.begin() + (y - part.y) * part.width + (left - part.x), right - left,
                shown.begin() + y * part.full_width + left);
  return shown;
}

// An EXIF orientation is what is done to the stored picture: 2 mirrored, 3 turned by half, 4 upside down, 5 to 8 with
// rows and columns exchanged.
std::vector<float> upright(int orientation, std::uint32_t width, std::uint32_t height, std::vector<float> plane) {
  if (orientation < 2 || orientation > 8) return plane;
  const bool exchanged = orientation >= 5;
  const bool right_first = orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8,
             bottom_first = orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  const std::size_t columns = exchanged ? height : width, rows = exchanged ? width : height;
  std::vector<float> turned(plane.size());
  for (std::size_t y = 0; y < rows; ++y)
    for (std::size_t x = 0; x < columns; ++x) {
      const std::size_t across = exchanged ? y : x, down = exchanged ? x : y;
      const std::size_t column = right_first ? width - 1 - across : across,
                        row = bottom_first ? height - 1 - down : down;
      turned[y * columns + x] = plane[row * width + column];
    }
  return turned;
}

void decode_values(const StoredPart& part, std::vector<float>& values) {
  if (part.encoding == Encoding::srgb)
    for (float& value : values) value = static_cast<float>(linear_from_srgb(static_cast<double>(value)));
  if (part.encoding == Encoding::gamma)
    for (float& value : values)
      value = static_cast<float>(std::pow(std::max(static_cast<double>(value), 0.0), part.gamma));
}

void convert_colours(const std::array<float, 8>& chromaticities, bool light, std::vector<std::vector<float>>& planes) {
  const glm::dmat3 matrix = to_rec709(chromaticities);
  for (std::size_t i = 0; i < planes[0].size(); ++i) {
    const glm::dvec3 stored(planes[0][i], planes[1][i], planes[2][i]);
    const bool clips = light && stored.x >= 0.0 && stored.y >= 0.0 && stored.z >= 0.0;
    const glm::dvec3 converted = matrix * stored;
    for (int c = 0; c < 3; ++c)
      planes[static_cast<std::size_t>(c)][i] = static_cast<float>(clips ? std::max(converted[c], 0.0) : converted[c]);
  }
}

// R, G and B as they are to be shown.
std::vector<std::vector<float>> colours_of(const Stored& stored, bool light) {
  const StoredPart& part = stored.part;
  std::vector<std::vector<float>> colours;
  for (const std::size_t channel : stored.colours.rgb) {
    if (!colours.empty() && stored.colours.grey()) {
      colours.push_back(colours.front());
      continue;
    }
    std::vector<float>& values = colours.emplace_back(stored.planes[stored.index_of(channel)]);
    decode_values(part, values);
    if (!part.unassociated_alpha) continue;
    const std::vector<float>& alpha = stored.planes[stored.index_of(*part.unassociated_alpha)];
    for (std::size_t i = 0; i < values.size(); ++i) values[i] *= alpha[i];
  }
  const bool converts = part.chromaticities && !is_rec709(*part.chromaticities) && !stored.colours.grey();
  if (converts) convert_colours(*part.chromaticities, light, colours);
  return colours;
}

LinearPicture read_stored(const std::string& path, const char* format, const ReadRequest& request) {
  const PictureModule& module = picture_module(path);
  Stored stored;
  stored.planes = module.read(path, format, available_memory(), [&](const std::vector<StoredPart>& parts) {
    return choose(path, request, parts, stored);
  });
  const StoredPart& part = stored.part;
  LinearPicture picture{.width = part.full_width, .height = part.full_height, .channels = {}, .planes = {}};
  picture.display = part.display;
  picture.planes = colours_of(stored, request.light);
  picture.channels.assign(std::begin(kColourNames), std::end(kColourNames));
  for (const std::size_t channel : stored.channels) {
    if (std::ranges::count(stored.colours.rgb, channel) > 0) continue;
    if (!request.wanted || !request.wanted(part.channels[channel])) continue;
    picture.channels.push_back(part.channels[channel]);
    picture.planes.push_back(std::move(stored.planes[stored.index_of(channel)]));
  }
  for (std::vector<float>& plane : picture.planes) {
    plane = in_display_window(part, std::move(plane));
    plane = upright(part.orientation, part.full_width, part.full_height, std::move(plane));
  }
  if (part.orientation >= 5 && part.orientation <= 8) std::swap(picture.width, picture.height);
  if (request.environment && part.cube) {
    for (std::vector<float>& plane : picture.planes) plane = lat_long_of_cube(plane, part.width);
    picture.width = 4 * part.width;
    picture.height = 2 * part.width;
  }
  return picture;
}

} // namespace

LinearPicture read_linear(const std::string& path, const ReadRequest& request) {
  const char* format = stored_format(path);
  if (!format)
    throw Error(path, "cannot be opened as an image: is no picture of a format that can be read",
                std::string("give ") + kReadablePictures);
  try {
    const bool lean = !std::strcmp(format, "png") || !std::strcmp(format, "jpeg") || !std::strcmp(format, "webp");
    return lean ? read_decoded(path, request) : read_stored(path, format, request);
  } catch (const ImageError& error) {
    throw Error(path, std::string("cannot be opened as an image: ") + error.what(),
                "check that it is a complete picture that other programs can open");
  }
}

} // namespace wavepath
