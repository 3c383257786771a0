#include "host/picture/exposure.h"

#include <algorithm>
#include <cmath>

namespace wavepath {
namespace {

constexpr std::uint32_t kBlocks = 96; // along the longer side

// Values that are not finite or negative count as none.
double luminance_at(const Picture& picture, std::size_t i) {
  const auto value = [&](std::size_t c) {
    const double v = picture.channels[c].values[i];
    return v > 0.0 && std::isfinite(v) ? v : 0.0;
  };
  return 0.2126 * value(0) + 0.7152 * value(1) + 0.0722 * value(2);
}

// Blocks that are mostly transparent show something else, whatever they add to it. `alpha`: null = none is.
bool is_seen(const Picture& picture, const std::vector<float>* alpha, std::uint32_t left, std::uint32_t top,
             std::uint32_t right, std::uint32_t bottom, double& opaque) {
  opaque = double(bottom - top) * double(right - left);
  if (!alpha) return true;
  const double pixels = opaque;
  opaque = 0.0;
  for (std::uint32_t y = top; y < bottom; ++y)
    for (std::uint32_t x = left; x < right; ++x) opaque += (*alpha)[std::size_t{y} * picture.width + x];
  return opaque >= 0.5 * pixels;
}

std::vector<double> block_luminances(const Picture& picture) {
  const auto a = std::ranges::find(picture.channels, "A", &Channel::name);
  const std::vector<float>* alpha = a == picture.channels.end() ? nullptr : &a->values;

  const std::uint32_t side = std::max((std::max(picture.width, picture.height) + kBlocks - 1) / kBlocks, 1u);
  std::vector<double> blocks;
  for (std::uint32_t top = 0; top < picture.height; top += side)
    for (std::uint32_t left = 0; left < picture.width; left += side) {
      const std::uint32_t bottom = std::min(top + side, picture.height), right = std::min(left + side, picture.width);
      double sum = 0.0;
      for (std::uint32_t y = top; y < bottom; ++y)
        for (std::uint32_t x = left; x < right; ++x) sum += luminance_at(picture, std::size_t{y} * picture.width + x);
      double opaque = 0.0;
      if (sum > 0.0 && is_seen(picture, alpha, left, top, right, bottom, opaque)) blocks.push_back(sum / opaque);
    }
  return blocks;
}

} // namespace

double auto_exposure(const Picture& picture) {
  std::vector<double> blocks = block_luminances(picture);
  if (blocks.empty()) return 0.0;
  double mean = 0.0;
  for (const double block : blocks) mean += block / static_cast<double>(blocks.size());
  double stops = 0.0;
  for (const double block : blocks) stops += std::log2(std::max(block, mean / 256.0));
  const double middle = stops / static_cast<double>(blocks.size());
  const auto bright = blocks.begin() + static_cast<std::ptrdiff_t>(blocks.size() - 1 - blocks.size() / 20);
  std::nth_element(blocks.begin(), bright, blocks.end());
  const double exposure = std::min(std::log2(kMiddle) - middle, std::log2(kBright / *bright));
  return std::round(100.0 * std::clamp(exposure, -64.0, 64.0)) / 100.0;
}

} // namespace wavepath
