#include "host/integrators/path/guiding.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

namespace wavepath {
namespace {

constexpr std::uint32_t kSeed = 0x6a09e667u; // by exclusive or with the render's own
constexpr std::uint32_t kFirstPaths = 1u << 15; // of the first iteration; each has twice as many as the one before
constexpr std::uint32_t kIterations = 5;
constexpr std::uint32_t kLeastIterations = 2;
constexpr std::uint32_t kMostSamples = 64; // a pixel, in an iteration: small pictures learn from fewer paths

// A guided sample costs about 1.2 times an unguided one, so that it has to have less of the second moment than
// 1 / 1.2. Later iterations know more than the first ones: what is given up early promised hardly anything.
constexpr double kPays = 0.8, kHopeless = 0.95;

double tunable(const char* name, double value) {
  const char* text = std::getenv(name);
  return text ? std::atof(text) : value;
}

} // namespace

GuidePilot::GuidePilot(std::uint32_t width, std::uint32_t height) : width_(width), height_(height) {
  const double scale = std::sqrt(kGuidePilotPixels / (static_cast<double>(width) * height));
  if (scale >= 1.0) return;
  width_ = std::clamp(static_cast<std::uint32_t>(width * scale), 1u, kGuidePilotPixels);
  height_ = std::min(height, kGuidePilotPixels / width_);
}

std::uint32_t GuidePilot::iteration_end(std::uint32_t iteration) const {
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i <= iteration; ++i)
    end += std::clamp(((kFirstPaths << i) + pixels() / 2) / pixels(), 1u << i, kMostSamples);
  return end;
}

GuideReport GuidePilot::report() const {
  return {.used = field_.probability > 0.0 && field_.gain < tunable("G_PAYS", kPays),
          .predicted_moment = field_.gain,
          .probability = field_.probability,
          .leaves = field_.leaves(),
          .bytes = field_.nodes.size() * sizeof(gpu::GuideNode) + field_.maps.size() * sizeof(gpu::vec4),
          .pilot_paths = std::uint64_t{sample_} * pixels()};
}

Pilot GuidePilot::next() const {
  return {.segments = {{0, 0, pixels(), 0}},
          .samples = 1,
          .seed = kSeed,
          .first_sample = sample_,
          .width = width_,
          .height = height_};
}

bool GuidePilot::take(const Buffer& records) {
  const auto notes = download<gpu::GuideRecord>(records, std::size_t{pixels()} * gpu::kGuideBounces);
  for (std::size_t path = 0; path < pixels(); ++path)
    for (std::size_t bounce = 0; bounce < gpu::kGuideBounces; ++bounce) {
      const gpu::GuideRecord& note = notes[path * gpu::kGuideBounces + bounce];
      if (note.pdf == 0.0f || !std::isfinite(note.after)) break;
      const float gained = std::max(note.after - note.before, 0.0f);
      if (note.pdf < 0.0f || !std::isfinite(gained) || !(note.throughput > 0.0f)) continue;
      const float radiance = gained / note.throughput;
      if (!std::isfinite(radiance) || !std::isfinite(radiance / note.pdf)) continue;
      vertices_.push_back({note.position, note.pdf, note.direction, note.bsdf_pdf, note.share, radiance, gained, (path & 1) != 0});
    }
  if (++sample_ < iteration_end(iteration_)) return false;
  field_ = build_field(vertices_);
  if (std::getenv("G_VERBOSE"))
    fmt::print(stderr, "guide iteration {}: {} vertices, {} leaves, gain {:.4f}, probability {:.3f}\n", iteration_,
               vertices_.size(), field_.leaves(), field_.gain, field_.probability);
  vertices_.clear();
  ++iteration_;
  const bool hopeless = iteration_ > kLeastIterations - 1 && field_.gain > tunable("G_HOPE", kHopeless);
  done_ = hopeless || iteration_ == tunable("G_ITER", kIterations);
  return true;
}

} // namespace wavepath
