// Comparison of the interface.
#include <wavepath/compare.h>

#include <numeric>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/library/guard.h"
#include "host/picture/metrics/metrics.h"
#include "host/render/report/comparison.h"
#include "host/render/report/stats.h"

namespace wavepath_v0 {
namespace {

wavepath::Picture picture_of(const char* name, const Pixels& pixels) {
  const std::size_t count = std::size_t{pixels.width} * pixels.height;
  if (count == 0 || pixels.rgb.size() != 3 * count)
    throw wavepath::UsageError(
        name, fmt::format("has {} values for {}x{} pixels", pixels.rgb.size(), pixels.width, pixels.height),
        "give three for each pixel");
  wavepath::Picture picture{pixels.width, pixels.height, {}};
  for (std::size_t c = 0; c < 3; ++c) {
    wavepath::Channel channel{std::string(1, "RGB"[c]), std::vector<float>(count)};
    for (std::size_t i = 0; i < count; ++i) channel.values[i] = pixels.rgb[3 * i + c];
    picture.channels.push_back(std::move(channel));
  }
  return picture;
}

} // namespace

std::string compare(const Pixels& image, const Pixels& reference) {
  return wavepath::guarded([&] {
    const wavepath::Picture a = picture_of("image", image), b = picture_of("reference", reference);
    const wavepath::PictureMetrics metrics = wavepath::compare_pictures(a, b, 0.0);
    double flip = 0.0;
    if (metrics.finite()) {
      const std::vector<float> map = wavepath::hdr_flip(a, b);
      flip = std::accumulate(map.begin(), map.end(), 0.0) / static_cast<double>(map.size());
    }
    nlohmann::ordered_json document;
    wavepath::add_metrics(document, metrics, flip);
    return wavepath::to_text(document);
  });
}

} // namespace wavepath_v0
