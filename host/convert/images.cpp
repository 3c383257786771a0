#include "host/convert/images.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/codecs/decode.h"
#include "host/codecs/linear_picture.h"
#include "host/codecs/png.h"
#include "host/codecs/srgb.h"

namespace wavepath::convert {
namespace {

double encoded_srgb(double linear) {
  return linear <= 0.0031308 ? linear * 12.92 : 1.055 * std::pow(linear, 1.0 / 2.4) - 0.055;
}

constexpr std::uint32_t kMostImageSide = 16384; // as textures of the program

void check_image(const std::string& path, std::uint32_t width, std::uint32_t height) {
  if (width > kMostImageSide || height > kMostImageSide)
    throw Error(path, "is larger than 16384 x 16384 pixels", "make it smaller");
}

Pixels decoded_pixels(const std::vector<std::uint8_t>& bytes, Holds holds, double scale) {
  const std::optional<FileFormat> format = file_format(bytes);
  const DecodedImage image = decode(format.value(), bytes, [](const ImageShape&) {});
  const std::size_t channels = image.shape.channels;
  const bool is_grey = channels < 3, has_alpha = channels == 2 || channels == 4;
  Pixels pixels{image.shape.width, image.shape.height, {}};
  pixels.values.resize(image.shape.pixels());
  const auto sample = [&](std::size_t i) {
    return image.bytes.empty() ? static_cast<double>(image.words[i]) / 65535.0 : image.bytes[i] / 255.0;
  };
  double linear[256];
  for (int i = 0; i < 256; ++i) linear[i] = linear_from_srgb(i / 255.0);
  for (std::size_t p = 0; p < pixels.values.size(); ++p) {
    glm::vec4& value = pixels.values[p];
    for (std::size_t c = 0; c < 3; ++c) {
      const std::size_t i = p * channels + (is_grey ? 0 : c);
      const double stored = sample(i);
      const double meant = holds == Holds::numbers ? stored
                           : image.bytes.empty()   ? linear_from_srgb(stored)
                                                   : linear[image.bytes[i]];
      value[static_cast<int>(c)] = static_cast<float>(meant * scale);
    }
    value.a = has_alpha ? static_cast<float>(sample(p * channels + channels - 1)) : 1.0f;
  }
  return pixels;
}

// Every other format is read by the decoders of environments.
Pixels read_pixels(const std::string& path, Holds holds) {
  ReadRequest request;
  request.wanted = [](const std::string& name) { return name == "A"; };
  request.check = [&](std::uint32_t width, std::uint32_t height) { check_image(path, width, height); };
  const LinearPicture picture = read_linear(path, request);
  Pixels pixels{picture.width, picture.height, {}};
  pixels.values.resize(std::size_t{picture.width} * picture.height, glm::vec4(0, 0, 0, 1));
  for (std::size_t c = 0; c < picture.planes.size(); ++c) {
    const bool is_alpha = picture.channels[c] == "A";
    if (c >= 3 && !is_alpha) continue;
    for (std::size_t p = 0; p < pixels.values.size(); ++p) {
      float value = picture.planes[c][p];
      if (!std::isfinite(value)) value = 0.0f;
      // Numbers of 8 bits were decoded as if they were colours.
      if (holds == Holds::numbers && picture.display && !is_alpha)
        value = static_cast<float>(encoded_srgb(static_cast<double>(value)));
      pixels.values[p][is_alpha ? 3 : static_cast<int>(c)] = value;
    }
  }
  return pixels;
}

std::vector<std::uint8_t> encoded(const Pixels& pixels, Holds holds, double scale) {
  const bool has_alpha = std::ranges::any_of(pixels.values, [](const glm::vec4& value) { return value.a < 1.0f; });
  DecodedImage image;
  image.shape = {pixels.width, pixels.height, has_alpha ? 4u : 3u};
  image.bytes.reserve(pixels.values.size() * image.shape.channels);
  const auto to_byte = [](double value) {
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(value, 0.0, 1.0)));
  };
  for (const glm::vec4& value : pixels.values) {
    for (int c = 0; c < 3; ++c) {
      const double stored = std::clamp(static_cast<double>(value[c]) / scale, 0.0, 1.0);
      image.bytes.push_back(to_byte(holds == Holds::colors ? encoded_srgb(stored) : stored));
    }
    if (has_alpha) image.bytes.push_back(to_byte(static_cast<double>(value.a)));
  }
  return encode_png(image);
}

} // namespace

const glm::vec4& Pixels::at(double u, double v) const {
  const auto wrapped = [](double x, std::uint32_t size) {
    const double within = x - std::floor(x);
    return std::min(static_cast<std::uint32_t>(within * size), size - 1);
  };
  return values[std::size_t{wrapped(v, height)} * width + wrapped(u, width)];
}

std::uint32_t Images::add_file(const std::string& path, Holds holds) {
  const auto [found, is_new] = files_.emplace(std::pair{path, holds}, static_cast<std::uint32_t>(images_.size()));
  if (!is_new) return found->second;
  try {
    Image image;
    image.name = std::filesystem::path(path).stem().string();
    image.holds = holds;
    std::optional<std::vector<std::uint8_t>> bytes = read_whole_file(path);
    if (!bytes) throw Error(path, "cannot be read", "check the name and its permissions");
    const std::optional<FileFormat> format = file_format(*bytes);
    if (format == FileFormat::png || format == FileFormat::jpeg) {
      try { // the header, and whether it can be decoded later
        decode(*format, *bytes, [&](const ImageShape& shape) { check_image(path, shape.width, shape.height); });
      } catch (const ImageError& error) {
        throw Error(path, error.what(), "repair the picture");
      }
      image.mime = format == FileFormat::png ? "image/png" : "image/jpeg";
      image.bytes = std::move(*bytes);
    } else {
      Pixels pixels = read_pixels(path, holds);
      for (const glm::vec4& value : pixels.values)
        image.scale = std::max(
            {image.scale, static_cast<double>(value.r), static_cast<double>(value.g), static_cast<double>(value.b)});
      image.mime = "image/png";
      image.bytes = encoded(pixels, holds, image.scale);
    }
    images_.push_back(std::move(image));
  } catch (...) {
    files_.erase(found);
    throw;
  }
  return static_cast<std::uint32_t>(images_.size() - 1);
}

std::uint32_t Images::add(const std::string& name, const Pixels& pixels, Holds holds) {
  images_.push_back({name, "image/png", encoded(pixels, holds, 1.0), holds, 1.0});
  return static_cast<std::uint32_t>(images_.size() - 1);
}

const Pixels& Images::pixels(std::uint32_t image) {
  const auto [found, is_new] = pixels_.try_emplace(image);
  if (is_new) {
    const Image& source = images_[image];
    found->second = decoded_pixels(source.bytes, source.holds, source.scale);
  }
  return found->second;
}

} // namespace wavepath::convert
