// Reads and checks environment maps; see environment.h.
#include "host/scene/staging/environment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

#include "host/base/error.h"
#include "host/codecs/linear_picture.h"
#include "host/codecs/stored_format.h"
#include "host/scene/staging/environment_sky.h"
#include "host/scene/staging/environment_studio.h"

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

void read_map(const std::string& file, Environment& environment) {
  const LinearPicture picture = read_linear(
      file, {.environment = true, .light = true, .wanted = {}, .check = [&](std::uint32_t width, std::uint32_t height) {
               check_size(file, width, height);
             }});
  environment.width = picture.width;
  environment.height = picture.height;
  environment.map.resize(picture.planes[0].size());
  for (std::size_t i = 0; i < environment.map.size(); ++i) {
    environment.map[i] = {picture.planes[0][i], picture.planes[1][i], picture.planes[2][i]};
    check_texel(file, environment.map[i], i % environment.width, i / environment.width);
  }
}

// True if the text looks like the name of a file, not like a misspelled name of an environment.
bool names_file(const std::string& source) {
  std::error_code error;
  return std::filesystem::path(source).has_extension() || source.find('/') != std::string::npos ||
         std::filesystem::exists(source, error);
}

// Sums of radiance overflow above, as of the lights of a file.
constexpr double kBrightestEnvironment = 1e30;

Environment not_too_bright(Environment environment, double intensity) {
  double largest = 1.0;
  if (!environment.map.empty()) largest = 0.0;
  for (const glm::vec3& texel : environment.map)
    largest = std::max<double>(largest, std::max({texel.r, texel.g, texel.b}));
  largest *= std::max({environment.radiance.r, environment.radiance.g, environment.radiance.b});
  if (!(largest <= kBrightestEnvironment)) {
    std::ostringstream value;
    value << largest;
    if (intensity == 1.0)
      throw UsageError("--env", "is as bright as " + value.str() + ", more than 1e30", "give a darker environment");
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
    return not_too_bright(std::move(environment), intensity);
  }
  if (std::ranges::count(kEnvironmentNames, source) > 0) {
    Environment builtin = make_builtin(source);
    builtin.radiance *= environment.radiance;
    builtin.rotation = rotation;
    return not_too_bright(std::move(builtin), intensity);
  }
  if (!names_file(source))
    throw UsageError("--env", "'" + source + "' is neither R,G,B nor a picture file, nor studio, sky, black or white",
                     "give one of these names, a constant such as 1,1,1, or a lat-long image");
  std::error_code error;
  if (!std::filesystem::exists(source, error))
    throw Error(source, "does not exist", std::string("give a lat-long image (") + kReadablePictures + "), or R,G,B");
  read_map(source, environment);
  return not_too_bright(std::move(environment), intensity);
}

} // namespace wavepath
