// Reads and checks environment maps; see environment.h.
#include "host/scene/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/images/exr_planes.h"
#include "host/images/radiance.h"
#include "host/scene/environment_sky.h"
#include "host/scene/environment_studio.h"

namespace wavepath {
namespace {

constexpr std::uint64_t kMostTexels = std::uint64_t{1} << 27; // 2 GiB as RGBA32F, the most that a texel buffer holds

std::optional<double> parse_number(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0.0;
  if (!(stream >> value) || !stream.eof()) return std::nullopt;
  return value;
}

// No value if the text is not a comma-separated list of numbers.
std::optional<glm::vec3> parse_rgb(const std::string& text) {
  if (std::count(text.begin(), text.end(), ',') != 2) return std::nullopt;
  std::istringstream stream(text);
  glm::vec3 rgb;
  std::string part;
  for (int c = 0; c < 3; ++c) {
    std::getline(stream, part, ',');
    const std::optional<double> value = parse_number(part);
    if (!value) return std::nullopt;
    rgb[c] = static_cast<float>(*value);
  }
  return rgb;
}

std::string lower_extension(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

// The names of red, green and blue; a single channel counts as grey.
std::vector<std::string> choose_channels(const std::string& file, const std::vector<std::string>& channels) {
  const std::vector<std::string> rgb{"R", "G", "B"};
  if (std::ranges::all_of(rgb, [&](const std::string& c) { return std::ranges::count(channels, c) > 0; })) return rgb;
  if (channels.size() == 1) return channels;
  std::string names;
  for (const std::string& name : channels) names += (names.empty() ? "" : ", ") + name;
  throw Error(file, "has no R, G and B channels (it has " + names + ")", "save the environment as an RGB image");
}

void check_size(const std::string& file, std::uint32_t width, std::uint32_t height) {
  if (std::uint64_t{width} * height > kMostTexels)
    throw Error(
        file,
        "is " + std::to_string(width) + " x " + std::to_string(height) + " pixels, more than 134217728 altogether",
        "scale the environment down");
}

void check_texel(const std::string& file, const glm::vec3& rgb, std::size_t x, std::size_t y) {
  for (int c = 0; c < 3; ++c) {
    if (std::isfinite(rgb[c]) && rgb[c] >= 0.0f) continue;
    std::ostringstream value;
    value << rgb.r << ", " << rgb.g << ", " << rgb.b;
    throw Error(
        file,
        "pixel (" + std::to_string(x) + ", " + std::to_string(y) + ") is " + value.str() + ", which is no radiance",
        "repair the image: every value must be finite and not negative");
  }
}

void read_exr_map(const std::string& file, Environment& environment) {
  const auto planes = read_exr_planes(file, [&](const ExrShape& shape) {
    check_size(file, shape.width, shape.height);
    if (shape.cropped)
      throw Error(file,
                  "has a data window (" + std::to_string(shape.width) + " x " + std::to_string(shape.height) +
                      ") that differs from its display window",
                  "save the environment uncropped");
    environment.width = shape.width;
    environment.height = shape.height;
    return choose_channels(file, shape.channels);
  });
  environment.map.resize(planes[0].size());
  for (std::size_t i = 0; i < environment.map.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c)
      environment.map[i][static_cast<int>(c)] = planes[std::min(c, planes.size() - 1)][i];
}

void read_hdr_map(const std::string& file, Environment& environment) {
  const std::optional<std::vector<std::uint8_t>> bytes = read_whole_file(file);
  if (!bytes) throw Error(file, "cannot be read", "check its permissions");
  const DecodedImage image =
      decode_radiance(*bytes, [&](const ImageShape& shape) { check_size(file, shape.width, shape.height); });
  environment.width = image.shape.width;
  environment.height = image.shape.height;
  environment.map.resize(image.shape.pixels());
  for (std::size_t i = 0; i < environment.map.size(); ++i)
    environment.map[i] = {image.floats[3 * i], image.floats[3 * i + 1], image.floats[3 * i + 2]};
}

void read_map(const std::string& file, bool is_exr, Environment& environment) {
  if (!std::filesystem::exists(file)) throw Error(file, "does not exist", "give a .exr or .hdr file, or R,G,B");
  try {
    is_exr ? read_exr_map(file, environment) : read_hdr_map(file, environment);
  } catch (const ImageError& error) {
    throw Error(file, std::string("cannot be opened as an image: ") + error.what(),
                "give a lat-long .exr or .hdr image that other programs can open");
  }
  for (std::size_t i = 0; i < environment.map.size(); ++i)
    check_texel(file, environment.map[i], i % environment.width, i / environment.width);
}

// Sums of radiance overflow above, as of the lights of a file.
constexpr double kBrightestEnvironment = 1e30;

Environment not_too_bright(Environment environment) {
  double largest = 1.0;
  if (!environment.map.empty()) largest = 0.0;
  for (const glm::vec3& texel : environment.map)
    largest = std::max<double>(largest, std::max({texel.r, texel.g, texel.b}));
  largest *= std::max({environment.radiance.r, environment.radiance.g, environment.radiance.b});
  if (!(largest <= kBrightestEnvironment)) {
    std::ostringstream value;
    value << largest;
    throw UsageError("--env-intensity", "makes the environment as bright as " + value.str() + ", more than 1e30",
                     "give a smaller factor, or a darker environment");
  }
  return environment;
}

Environment make_builtin(const std::string& name) {
  if (name == "studio") return studio_environment();
  if (name == "sky") return sky_environment();
  Environment constant;
  constant.radiance = glm::vec3(name == "white" ? 1.0f : 0.0f);
  return constant;
}

} // namespace

Environment load_environment(const std::string& source, double intensity, double rotation) {
  if (!std::isfinite(intensity) || intensity < 0.0)
    throw UsageError("--env-intensity", "must be a finite number that is not negative", "give 0 or more");
  if (!std::isfinite(rotation)) throw UsageError("--env-rotation", "must be a finite angle", "give degrees");

  Environment environment;
  environment.rotation = rotation;
  environment.radiance = glm::vec3(static_cast<float>(intensity));
  if (const std::optional<glm::vec3> rgb = parse_rgb(source)) {
    environment.radiance *= *rgb;
    for (int c = 0; c < 3; ++c)
      if (!std::isfinite(environment.radiance[c]) || environment.radiance[c] < 0.0f)
        throw UsageError("--env", "radiance " + source + " must be finite and not negative", "give R,G,B of 0 or more");
    return not_too_bright(std::move(environment));
  }
  if (std::ranges::count(kEnvironmentNames, source) > 0) {
    Environment builtin = make_builtin(source);
    builtin.radiance *= environment.radiance;
    builtin.rotation = rotation;
    return not_too_bright(std::move(builtin));
  }
  const std::string extension = lower_extension(source);
  if (extension != ".exr" && extension != ".hdr")
    throw UsageError("--env",
                     "'" + source + "' is neither R,G,B nor a .exr or .hdr file, nor studio, sky, black or white",
                     "give one of these names, a constant such as 1,1,1, or a lat-long image of one of these types");
  read_map(source, extension == ".exr", environment);
  return not_too_bright(std::move(environment));
}

} // namespace wavepath
