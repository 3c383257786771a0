#include "host/integrators/path/guiding.h"

#include <algorithm>
#include <cmath>

namespace wavepath {
namespace {

constexpr std::uint32_t kSeed = 0x6a09e667u;    // exclusive-ored with the seed of the render
constexpr std::uint32_t kFirstPaths = 1u << 16; // paths of the first two iterations; each later one has twice as many
constexpr std::uint32_t kLeastIterations = 2;
// Most samples a pixel in an iteration: small pictures train on fewer paths. Iterations that only long renders have may
// be longer.
constexpr std::uint32_t kMostSamples = 64, kMostSamplesIfLong = 1024;
constexpr std::size_t kTrainsOn = 3; // number of latest iterations that a field is trained on

// Predicted variance below which the picture is guided, and above which training ends early. A guided sample costs
// about 1.3 times an unguided one (llvmpipe).
constexpr double kPays = 0.75, kHopeless = 0.85;

// Converts the records of a path to vertices, in their order. `scale`: of the pixel. Returns the luminance from the
// first direction that could be guided.
float add_vertices(const gpu::GuideRecord* notes, float scale, bool odd, std::vector<GuideVertex>& vertices) {
  float first = -1.0f;
  for (std::size_t bounce = 0; bounce < gpu::kGuideBounces; ++bounce) {
    const gpu::GuideRecord& note = notes[bounce];
    if (note.pdf == 0.0f) break;
    const float gained = std::max(note.after - note.before, 0.0f);
    if (note.pdf < 0.0f || !std::isfinite(gained) || !(note.throughput > 0.0f)) continue;
    if (first < 0.0f) first = gained;
    const float radiance = gained / note.throughput;
    if (!std::isfinite(radiance) || !std::isfinite(radiance / note.pdf)) continue;
    vertices.push_back({note.position, note.pdf, note.direction, note.bsdf_pdf, note.guidable_fraction, radiance,
                        scale * gained, odd});
  }
  return std::max(first, 0.0f);
}

} // namespace

GuideTraining::GuideTraining(std::uint32_t width, std::uint32_t height, std::uint32_t most_iterations)
    : width_(width), height_(height), most_iterations_(most_iterations) {
  const double scale = std::sqrt(kGuideTrainingPixels / (static_cast<double>(width) * height));
  if (scale >= 1.0) return;
  width_ = std::clamp(static_cast<std::uint32_t>(width * scale), 1u, kGuideTrainingPixels);
  height_ = std::min(height, kGuideTrainingPixels / width_);
}

std::uint32_t GuideTraining::iteration_end(std::uint32_t iteration) const {
  std::uint32_t end = 0;
  for (std::uint32_t i = 0; i <= iteration; ++i) {
    const std::uint32_t paths = kFirstPaths << (i > 0 ? i - 1 : 0);
    const std::uint32_t samples = std::max((paths + pixels() / 2) / pixels() / 2 * 2, 2u);
    end += std::min(samples, i < kGuideIterations ? kMostSamples : kMostSamplesIfLong);
  }
  return end;
}

// Fraction of a sample's variance that guided directions can change. The rest comes from light samples at first hits
// and from differences within a pixel. Both variances are estimated by half the mean square of the difference between
// two samples of a pixel.
double GuideTraining::guidable_fraction() const {
  double whole = 0.0, guidable = 0.0;
  for (std::size_t first = 0; first < samples_.size(); first += 2 * pixels())
    for (std::size_t pixel = first; pixel < first + pixels(); ++pixel) {
      const Sample a = samples_[pixel], b = samples_[pixel + pixels()];
      const double mean = double{sums_[pixel - first]} / sample_, weight = 1.0 / (mean * mean + 0.01);
      whole += weight * (a.all - b.all) * (a.all - b.all);
      guidable += weight * (a.scattered - b.scattered) * (a.scattered - b.scattered);
    }
  return whole > 0.0 ? std::min(guidable / whole, 1.0) : 0.0;
}

GuideReport GuideTraining::report() const {
  return {.used = field_.probability > 0.0 && promise_ < kPays,
          .variance = promise_,
          .probability = field_.probability,
          .leaves = field_.leaves(),
          .bytes = field_.nodes.size() * sizeof(gpu::GuideNode) + field_.maps.size() * sizeof(glm::uvec4),
          .training_paths = std::uint64_t{sample_} * pixels()};
}

// The vertices that a field trains on. The first fields use their own iteration alone. Later ones, of which one guides
// the picture, also use some earlier iterations, whose fields were poorer.
std::span<const GuideVertex> GuideTraining::training_vertices() const {
  return std::span(vertices_).subspan(iteration_ + 1 < kGuideIterations ? iteration_begins_.back() : 0);
}

// Discards vertices on which the next iteration does not train, and reserves memory for its own.
void GuideTraining::forget_vertices() {
  const std::size_t own = vertices_.size() - iteration_begins_.back();
  iteration_begins_.push_back(vertices_.size());
  if (iteration_begins_.size() > kTrainsOn) {
    const std::size_t forgotten = iteration_begins_[1];
    vertices_.erase(vertices_.begin(), vertices_.begin() + static_cast<std::ptrdiff_t>(forgotten));
    iteration_begins_.erase(iteration_begins_.begin());
    for (std::size_t& begin : iteration_begins_) begin -= forgotten;
  }
  vertices_.reserve(vertices_.size() + 2 * own); // an iteration has at most twice as many paths, but for small pictures
}

Pilot GuideTraining::next() const {
  return {.segments = {{0, 0, pixels(), 0}},
          .samples = 1,
          .seed = kSeed,
          .first_sample = sample_,
          .width = width_,
          .height = height_};
}

bool GuideTraining::take(const Buffer& records) {
  const auto notes = download<gpu::GuideRecord>(records, std::size_t{pixels()} * gpu::kGuideBounces);
  sums_.resize(pixels());
  for (std::size_t path = 0; path < pixels(); ++path) {
    const gpu::GuideRecord* of_path = &notes[path * gpu::kGuideBounces];
    if (!std::isfinite(of_path->after)) {
      samples_.push_back({0.0f, 0.0f});
      continue;
    }
    sums_[path] += of_path->after;
    const float mean = sums_[path] / static_cast<float>(sample_ + 1);
    const float scale = 1.0f / std::sqrt(mean * mean + 0.01f); // as relMSE weighs
    samples_.push_back({of_path->after, add_vertices(of_path, scale, (path & 1) != 0, vertices_)});
  }
  if (++sample_ < iteration_end(iteration_)) return false;

  field_ = build_field(training_vertices());
  const double fraction = guidable_fraction();
  promise_ = 1.0 - fraction * (1.0 - field_.gain);
  samples_.clear();
  ++iteration_;
  const bool hopeless = iteration_ >= kLeastIterations && promise_ > kHopeless;
  const bool unused = iteration_ >= kGuideIterations && promise_ >= kPays; // as in a shorter render
  done_ = hopeless || unused || iteration_ >= most_iterations_;
  if (!done_) forget_vertices();
  return true;
}

} // namespace wavepath
