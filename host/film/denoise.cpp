#include "host/film/denoise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "host/film/non_local_means.h"
#include "host/film/surface_guides.h"

namespace wavepath {
namespace {

using glm::vec3;

// Light is divided by the albedo, so that texture is not mistaken for noise. Highlights are not in proportion to it: a
// floor keeps those on dark paint from counting too much.
constexpr float kAlbedoFloor = 0.1f;
// Multiples of its neighbours' mean that an uncertain pixel may have.
constexpr float kRare = 4.0f;
constexpr float kSure = 2.0f;        // standard errors beyond which a bright pixel is believed
constexpr int kSpreadIterations = 7; // of a 3x3 filter with holes: 52 pixels of standard deviation
constexpr int kNear = 2;             // pixels around one whose neighbours are asked

float sum_of(const vec3& v) { return v.x + v.y + v.z; }

class Filter {
public:
  explicit Filter(const NoisyPicture& picture)
      : picture_(picture),
        width_(static_cast<int>(picture.width)),
        height_(static_cast<int>(picture.height)),
        guides_(surface_guides(picture)),
        albedo_(picture.pixels()),
        light_(picture.pixels()),
        variance_(picture.pixels()) {}

  std::vector<vec3> run() {
    demodulate();
    dim_outliers();
    smooth_variance();
    const std::vector<vec3> filtered = non_local_means(picture_.width, light_, variance_, guides_);
    // What the filter took from pixels or added to them goes back to where it was, far spread: the noise of so many
    // pixels is next to nothing, and the light as a whole stays.
    std::vector<vec3> change(picture_.pixels());
    each_pixel([&](std::size_t i) { change[i] = reflected(i) - filtered[i] * albedo_[i]; });
    for (int i = 0; i < kSpreadIterations; ++i) spread(change, 1 << i);
    std::vector<vec3> out(picture_.pixels());
    each_pixel([&](std::size_t i) {
      const vec3 light = picture_.emission[i] + filtered[i] * albedo_[i] + change[i];
      out[i] = glm::max(light, glm::min(picture_.color[i], 0.0f));
    });
    return out;
  }

private:
  template <class Body>
  void each_pixel(Body body) const {
    tbb::parallel_for(std::size_t{0}, static_cast<std::size_t>(height_), [&](std::size_t y) {
      for (std::size_t i = y * picture_.width; i < (y + 1) * picture_.width; ++i) body(i);
    });
  }

  // Calls body(pixel) for those around one that are seen, without it.
  template <class Body>
  void each_neighbour(std::size_t pixel, Body body) const {
    const int x = static_cast<int>(pixel) % width_, y = static_cast<int>(pixel) / width_;
    for (int v = std::max(y - kNear, 0); v <= std::min(y + kNear, height_ - 1); ++v)
      for (int u = std::max(x - kNear, 0); u <= std::min(x + kNear, width_ - 1); ++u) {
        const auto other = static_cast<std::size_t>(v) * picture_.width + static_cast<std::size_t>(u);
        if (other != pixel && guides_[other].disparity > 0.0f) body(other);
      }
  }

  // What emission seen directly leaves of the light.
  vec3 reflected(std::size_t i) const { return picture_.color[i] - picture_.emission[i]; }

  void demodulate() {
    each_pixel([&](std::size_t i) {
      albedo_[i] = glm::max(picture_.albedo[i], kAlbedoFloor);
      light_[i] = reflected(i) / albedo_[i];
      variance_[i] = sum_of(picture_.variance[i] / (albedo_[i] * albedo_[i]));
    });
  }

  // A pixel that is far brighter than its neighbours, and may be so by chance, would be left alone by filters, and its
  // light kept from the neighbours that it stands for.
  void dim_outliers() {
    const std::vector<vec3> light = light_;
    const std::vector<float> variance = variance_;
    each_pixel([&](std::size_t i) {
      const float own = sum_of(light[i]);
      float around = 0.0f, squares = 0.0f, count = 0.0f;
      each_neighbour(i, [&](std::size_t other) {
        const float value = std::abs(sum_of(light[other]));
        around += value, squares += value * value, count += 1.0f;
      });
      if (count == 0.0f || guides_[i].disparity == 0.0f) return;
      around /= count;
      const bool known = variance[i] == variance[i];
      const float deviation = known ? std::sqrt(variance[i]) : own;
      const float bound = std::max(kRare * around, own - kSure * deviation);
      const float share = own > bound ? bound / own : 1.0f;
      light_[i] = share * light[i];
      // Where nothing measured it, the variance is that of the neighbours.
      variance_[i] = share * share * (known ? variance[i] : std::max(0.0f, squares / count - around * around));
    });
  }

  // It comes from two values a pixel, so that it says little by itself.
  void smooth_variance() {
    const std::vector<float> variance = variance_;
    each_pixel([&](std::size_t i) {
      double sum = variance[i], count = 1.0;
      each_neighbour(i, [&](std::size_t other) { sum += variance[other], count += 1.0; });
      variance_[i] = static_cast<float>(std::min(sum / count, 1e30));
    });
  }

  // How much of one surface two pixels are; the same for both.
  float likeness(const SurfaceGuide& a, const SurfaceGuide& b, glm::vec2 offset) const {
    if (a.disparity == 0.0f || b.disparity == 0.0f) return 0.0f;
    const vec3 turn = a.normal - b.normal;
    const float turned = std::max(0.0f, glm::dot(turn, turn) - (a.spread + b.spread));
    const float away = b.disparity - a.disparity, rise_a = glm::dot(a.slope, offset),
                rise_b = glm::dot(b.slope, offset);
    const float off = std::abs(away - rise_a) / (std::abs(rise_a) + kDisparitySlack * a.disparity) +
                      std::abs(away - rise_b) / (std::abs(rise_b) + kDisparitySlack * b.disparity);
    return falloff(kNormalScale * turned + 0.5f * off);
  }

  // Calls body(pixel, weight) for the taps of a 3x3 filter with holes.
  template <class Body>
  void each_tap(std::size_t pixel, int step, Body body) const {
    const int x = static_cast<int>(pixel) % width_, y = static_cast<int>(pixel) / width_;
    for (int v = -1; v <= 1; ++v)
      for (int u = -1; u <= 1; ++u) {
        const int there_x = x + u * step, there_y = y + v * step;
        if (there_x < 0 || there_y < 0 || there_x >= width_ || there_y >= height_) continue;
        const auto other = static_cast<std::size_t>(there_y) * picture_.width + static_cast<std::size_t>(there_x);
        const float binomial = 1.0f / static_cast<float>(1 << (std::abs(u) + std::abs(v)));
        const bool self = other == pixel;
        body(other,
             self ? binomial : binomial * likeness(guides_[pixel], guides_[other], glm::vec2(u * step, v * step)));
      }
  }

  // Every pixel hands all of its light out, in proportion to weights and albedo: the sum stays to the last digit.
  void spread(std::vector<vec3>& light, int step) const {
    std::vector<vec3> portions(light.size());
    each_pixel([&](std::size_t i) {
      vec3 taken(0.0f);
      each_tap(i, step, [&](std::size_t other, float weight) { taken += weight * albedo_[other]; });
      portions[i] = light[i] / taken; // its own weight is positive
    });
    each_pixel([&](std::size_t i) {
      vec3 given(0.0f);
      each_tap(i, step, [&](std::size_t other, float weight) { given += weight * portions[other]; });
      light[i] = albedo_[i] * given;
    });
  }

  const NoisyPicture& picture_;
  int width_, height_;
  std::vector<SurfaceGuide> guides_;
  std::vector<vec3> albedo_;    // that light is divided by
  std::vector<vec3> light_;     // reflected, over the albedo
  std::vector<float> variance_; // of its channels together
};

} // namespace

std::vector<vec3> denoise(const NoisyPicture& picture) { return Filter(picture).run(); }

} // namespace wavepath
