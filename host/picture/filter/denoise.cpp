#include "host/picture/filter/denoise.h"

#include <algorithm>
#include <cmath>

#include <tbb/parallel_for.h>

#include "host/picture/filter/non_local_means.h"
#include "host/picture/filter/surface_guides.h"

namespace wavepath {
namespace {

using glm::vec3;

// Light is divided by the albedo, so that texture is not mistaken for noise. Highlights are not in proportion to it: a
// floor keeps those on dark paint from counting too much.
constexpr float kAlbedoFloor = 0.1f;
// A pixel that may be bright by chance has at most so many times the light of its neighbours.
constexpr float kRare = 4.0f;
// Standard errors beyond that bound up to which it is chance; twice as many are none. A few samples are no normal
// distribution, and the estimate of the error is as rough.
constexpr float kChance = 4.0f;
constexpr int kNear = 3;             // neighbours are pixels up to so far away
constexpr int kVarianceReach = 2;    // and for their variance
constexpr int kSpreadIterations = 7; // of a 3x3 filter with holes: 52 pixels of standard deviation

// The picture as it is filtered.
struct Layers {
  explicit Layers(const NoisyPicture& picture_)
      : picture(picture_),
        guides(surface_guides(picture_)),
        albedo(picture_.pixels()),
        light(picture_.pixels()),
        variance(picture_.pixels()) {}

  const NoisyPicture& picture;
  std::vector<SurfaceGuide> guides;
  std::vector<vec3> albedo;    // that light is divided by
  std::vector<vec3> light;     // reflected, over the albedo
  std::vector<float> variance; // of its channels together

  bool is_seen(std::size_t pixel) const { return guides[pixel].disparity > 0.0f; }
  // Radiance without directly visible emission.
  vec3 reflected(std::size_t pixel) const { return picture.color[pixel] - picture.emission[pixel]; }
};

float sum_of(const vec3& v) { return v.x + v.y + v.z; }

template <class Body>
void each_pixel(const NoisyPicture& picture, Body body) {
  tbb::parallel_for(std::size_t{0}, std::size_t{picture.height}, [&](std::size_t y) {
    for (std::size_t i = y * picture.width; i < (y + 1) * picture.width; ++i) body(i);
  });
}

// Calls body(pixel, x, y) for the pixels of a 2 reach + 1 square with holes of `step` that are in the picture, x and y
// being their distance.
template <class Body>
void each_around(const NoisyPicture& picture, std::size_t pixel, int reach, int step, Body body) {
  const auto width = static_cast<int>(picture.width), height = static_cast<int>(picture.height);
  const int x = static_cast<int>(pixel % picture.width), y = static_cast<int>(pixel / picture.width);
  for (int v = -reach; v <= reach; ++v)
    for (int u = -reach; u <= reach; ++u) {
      const int there_x = x + u * step, there_y = y + v * step;
      if (there_x < 0 || there_y < 0 || there_x >= width || there_y >= height) continue;
      body(static_cast<std::size_t>(there_y) * picture.width + static_cast<std::size_t>(there_x), u, v);
    }
}

void demodulate(Layers& layers) {
  each_pixel(layers.picture, [&](std::size_t i) {
    const vec3 albedo = glm::max(layers.picture.albedo[i], kAlbedoFloor);
    layers.albedo[i] = albedo;
    layers.light[i] = layers.reflected(i) / albedo;
    layers.variance[i] = sum_of(layers.picture.variance[i] / (albedo * albedo));
  });
}

// A pixel that is far brighter than its neighbours, and may be so by chance, would be left alone by filters, and its
// light kept from the neighbours that it stands for.
void dim_outliers(Layers& layers) {
  const std::vector<vec3> light = layers.light;
  const std::vector<float> known_variance = layers.variance;
  each_pixel(layers.picture, [&](std::size_t i) {
    float around = 0.0f, squares = 0.0f, count = 0.0f, most = 0.0f;
    each_around(layers.picture, i, kNear, 1, [&](std::size_t other, int, int) {
      if (other == i || !layers.is_seen(other)) return;
      const float value = std::abs(sum_of(light[other]));
      around += value, squares += value * value, count += 1.0f;
      most = std::max(most, known_variance[other]); // the pixel's own may be small by chance
    });
    if (count == 0.0f || !layers.is_seen(i)) return;
    around /= count;
    float& variance = layers.variance[i];
    const bool known = variance == variance;
    const float own = sum_of(light[i]), deviation = known ? std::sqrt(std::max(variance, most)) : own;
    const float excess = own - kRare * around;
    const float chance = excess > 0.0f ? std::clamp(2.0f * kChance * deviation / excess - 1.0f, 0.0f, 1.0f) : 0.0f;
    const float fraction = excess > 0.0f ? 1.0f - chance * excess / own : 1.0f;
    layers.light[i] = fraction * light[i];
    // Where nothing measured the variance, it is that of the neighbours.
    variance = fraction * fraction * (known ? variance : std::max(0.0f, squares / count - around * around));
  });
}

// The variance of a pixel comes from two values, so that it says little by itself: those of neighbours are added that
// may have the same mean. Where bright samples are rare, most pixels have none and next to no variance.
void smooth_variance(Layers& layers) {
  const std::vector<float> variance = layers.variance;
  each_pixel(layers.picture, [&](std::size_t i) {
    constexpr float kMost = 1e30f, kLeast = 1e-30f; // reciprocals are floats, too
    float sum = 0.0f, weights = 0.0f;
    const float own = std::min(variance[i], kMost);
    each_around(layers.picture, i, kVarianceReach, 1, [&](std::size_t other, int, int) {
      if (!layers.is_seen(other)) return;
      const vec3 change = layers.light[other] - layers.light[i];
      const float theirs = std::min(variance[other], kMost);
      const float weight = falloff(glm::dot(change, change) / (4.0f * (own + theirs) + kLeast));
      sum += weight * theirs, weights += weight;
    });
    layers.variance[i] = weights > 0.0f ? sum / weights : 0.0f;
  });
}

// Likeness of two pixels: whether they show the same surface. `offset`: from a to b. The result from b to a has the
// same bits.
float likeness(const SurfaceGuide& a, const SurfaceGuide& b, glm::vec2 offset) {
  if (a.disparity == 0.0f || b.disparity == 0.0f) return 0.0f;
  const vec3 parity = a.normal - b.normal;
  const float turned = std::max(0.0f, glm::dot(parity, parity) - (a.spread + b.spread));
  const float away = b.disparity - a.disparity, rise_a = glm::dot(a.slope, offset), rise_b = glm::dot(b.slope, offset);
  const float off = std::abs(away - rise_a) / (std::abs(rise_a) + kDisparitySlack * a.disparity) +
                    std::abs(away - rise_b) / (std::abs(rise_b) + kDisparitySlack * b.disparity);
  return falloff(kNormalScale * turned + 0.5f * off);
}

// Every pixel hands all of its light out, in proportion to likeness and `fractions`: the sum stays, to within rounding.
void spread(const Layers& layers, const std::vector<vec3>& fractions, std::vector<vec3>& light, int step) {
  const auto each_tap = [&](std::size_t pixel, auto body) {
    each_around(layers.picture, pixel, 1, step, [&](std::size_t other, int x, int y) {
      const float binomial = 1.0f / static_cast<float>(1 << (std::abs(x) + std::abs(y)));
      const float alike =
          other == pixel ? 1.0f : likeness(layers.guides[pixel], layers.guides[other], glm::vec2(x * step, y * step));
      body(other, binomial * alike);
    });
  };
  std::vector<vec3> portions(light.size());
  each_pixel(layers.picture, [&](std::size_t i) {
    vec3 taken(0.0f);
    each_tap(i, [&](std::size_t other, float weight) { taken += weight * fractions[other]; });
    portions[i] = light[i] / taken; // the pixel itself takes, too
  });
  each_pixel(layers.picture, [&](std::size_t i) {
    vec3 given(0.0f);
    each_tap(i, [&](std::size_t other, float weight) { given += weight * portions[other]; });
    light[i] = fractions[i] * given;
  });
}

} // namespace

std::vector<vec3> denoise(const NoisyPicture& picture) {
  Layers layers(picture);
  demodulate(layers);
  dim_outliers(layers);
  smooth_variance(layers);
  const std::vector<vec3> filtered = non_local_means(picture.width, layers.light, layers.variance, layers.guides);

  // Light that filtering took from pixels, or added, returns to its neighbourhood, spread widely: over so many pixels
  // its noise is negligible, and the total light stays the same. Bright pixels get most of it, so that the dark
  // surroundings of a highlight stay dark.
  std::vector<vec3> change(picture.pixels()), fractions(picture.pixels());
  each_pixel(picture, [&](std::size_t i) {
    change[i] = layers.reflected(i) - filtered[i] * layers.albedo[i];
    fractions[i] = layers.albedo[i] * std::clamp(sum_of(filtered[i]), 1e-6f, 1e12f);
  });
  for (int i = 0; i < kSpreadIterations; ++i) spread(layers, fractions, change, 1 << i);

  std::vector<vec3> out(picture.pixels());
  each_pixel(picture, [&](std::size_t i) {
    const vec3 light = picture.emission[i] + filtered[i] * layers.albedo[i] + change[i];
    out[i] = glm::max(light, glm::min(picture.color[i], 0.0f));
  });
  return out;
}

} // namespace wavepath
