// Reads and checks environment maps; see environment.h.
#include "host/scene/environment.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <sstream>

#include <OpenImageIO/imageio.h>

#include "host/base/error.h"
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

// Channel numbers of red, green and blue; a single channel counts as grey.
std::array<int, 3> find_channels(const std::string& file, const OIIO::ImageSpec& spec) {
  const auto index = [&](const char* name) { return spec.channelindex(name); };
  const std::array<int, 3> rgb{index("R"), index("G"), index("B")};
  if (rgb[0] >= 0 && rgb[1] >= 0 && rgb[2] >= 0) return rgb;
  if (spec.nchannels == 1) return {0, 0, 0};
  std::string names;
  for (const std::string& name : spec.channelnames) names += (names.empty() ? "" : ", ") + name;
  throw Error(file, "has no R, G and B channels (it has " + names + ")", "save the environment as an RGB image");
}

void check_shape(const std::string& file, const OIIO::ImageSpec& spec) {
  const std::string size = std::to_string(spec.width) + " x " + std::to_string(spec.height);
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.deep)
    throw Error(file, "is not a flat two-dimensional image", "give a lat-long .exr or .hdr image");
  if (std::uint64_t(spec.width) * std::uint64_t(spec.height) > kMostTexels)
    throw Error(file, "is " + size + " pixels, more than 134217728 altogether", "scale the environment down");
  if (spec.x != spec.full_x || spec.y != spec.full_y || spec.width != spec.full_width ||
      spec.height != spec.full_height)
    throw Error(file, "has a data window (" + size + ") that differs from its display window",
                "save the environment uncropped");
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

void read_map(const std::string& file, Environment& environment) {
  if (!std::filesystem::exists(file)) throw Error(file, "does not exist", "give a .exr or .hdr file, or R,G,B");
  const std::unique_ptr<OIIO::ImageInput> input = OIIO::ImageInput::open(file);
  const std::string remedy = "give a lat-long .exr or .hdr image that other programs can open";
  if (!input) throw Error(file, "cannot be opened as an image (" + OIIO::geterror() + ")", remedy);
  const OIIO::ImageSpec spec = input->spec();
  check_shape(file, spec);
  const std::array<int, 3> channels = find_channels(file, spec);

  environment.width = static_cast<std::uint32_t>(spec.width);
  environment.height = static_cast<std::uint32_t>(spec.height);
  environment.map.resize(std::size_t{environment.width} * environment.height);
  const int first = *std::min_element(channels.begin(), channels.end());
  const int count = *std::max_element(channels.begin(), channels.end()) + 1 - first;
  std::vector<float> values(environment.map.size() * static_cast<std::size_t>(count));
  if (!input->read_image(0, 0, first, first + count, OIIO::TypeDesc::FLOAT, values.data()))
    throw Error(file, "cannot be read (" + input->geterror() + ")", remedy);
  for (std::size_t i = 0; i < environment.map.size(); ++i) {
    for (int c = 0; c < 3; ++c)
      environment.map[i][c] =
          values[i * static_cast<std::size_t>(count) + static_cast<std::size_t>(channels[c] - first)];
    check_texel(file, environment.map[i], i % environment.width, i / environment.width);
  }
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
    return environment;
  }
  if (std::ranges::count(kEnvironmentNames, source) > 0) {
    Environment builtin = make_builtin(source);
    builtin.radiance *= environment.radiance;
    builtin.rotation = rotation;
    return builtin;
  }
  const std::string extension = lower_extension(source);
  if (extension != ".exr" && extension != ".hdr")
    throw UsageError("--env",
                     "'" + source + "' is neither R,G,B nor a .exr or .hdr file, nor studio, sky, black or white",
                     "give one of these names, a constant such as 1,1,1, or a lat-long image of one of these types");
  read_map(source, environment);
  return environment;
}

} // namespace wavepath
