#include "host/study/study.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <list>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "host/render/kernel_compiler.h"
#include "host/render/stats.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kReferenceSeed = 1u << 30; // apart from the seeds of the points
constexpr std::size_t kPicturesKept = 2;           // one of the last two is nearest to the time that all have in common
constexpr double kMostSamples = 1 << 18;

class StudyRun {
public:
  StudyRun(Device& device, const StudyScene& scene, const StudySettings& settings, const StudyCallback& progress)
      : device_(device), scene_(scene), settings_(settings), progress_(progress) {}

  Study run(std::optional<StudyReference> reference) {
    const double share = settings_.budget * (reference ? 1.0 : 1.0 - kReferenceShare);
    study_.reference = reference ? *std::move(reference) : render_reference();
    for (const Configuration& configuration : make_grid(settings_.vary, settings_.render))
      study_.series.push_back({configuration, {}, {}});
    if (!study_.interrupted) measure_all(share / static_cast<double>(study_.series.size()));
    return std::move(study_);
  }

private:
  RenderResult render_one(const RenderSettings& settings, KernelCompiler& kernels, const std::string& what) {
    const auto on_progress = [&](const Progress& progress) {
      return progress_({fmt::format("{}, {} spp", what, settings.last_sample), seconds_ + progress.seconds});
    };
    RenderResult result =
        render(device_, scene_.packed.at(settings.direct), scene_.view, settings, {.progress = on_progress}, kernels);
    seconds_ += result.seconds;
    study_.interrupted |= result.stop == StopReason::interrupted;
    return result;
  }

  // The strongest of what there is, with as many samples as a short trial says that there is time for.
  StudyReference render_reference() {
    RenderSettings settings = settings_.render;
    settings.sampler = gpu::kSamplerSobol;
    settings.direct = gpu::kDirectMis;
    settings.hemisphere = gpu::kHemisphereCosine;
    settings.seed = settings_.render.seed ^ kReferenceSeed;
    KernelCompiler kernels(device_);
    settings.last_sample = settings_.reference_spp;
    if (settings.last_sample == 0) settings.last_sample = affordable_samples(settings, kernels);
    RenderResult result = render_one(settings, kernels, "reference");
    return {std::move(result.picture), "", estimated_error(result), settings.seed, result.spp, result.seconds};
  }

  std::uint32_t affordable_samples(RenderSettings settings, KernelCompiler& kernels) {
    const double share = kReferenceShare * settings_.budget;
    constexpr double kTrial = 1.0 / 32.0; // of the share
    double seconds = 0.0;
    for (settings.last_sample = 1;; settings.last_sample *= 4) {
      seconds = render_one(settings, kernels, "trial for the reference").seconds;
      if (study_.interrupted || seconds > kTrial * share) break;
    }
    const double samples =
        std::numbers::sqrt2 * (share - seconds_) * settings.last_sample / seconds; // to the nearest power
    return std::bit_floor(static_cast<std::uint32_t>(std::clamp(samples, 2.0, kMostSamples)));
  }

  // By turns, so that what else happens on the machine meets all alike. A configuration ends where twice the time of
  // its last render would not fit into what is left of its share.
  void measure_all(double share) {
    std::list<KernelCompiler> kernels;
    std::vector<double> used(study_.series.size(), 0.0);
    std::vector<KernelCompiler*> active;
    for (std::size_t i = 0; i < study_.series.size(); ++i) active.push_back(&kernels.emplace_back(device_));
    for (std::uint32_t octave = 0; std::any_of(active.begin(), active.end(), [](auto* k) { return k != nullptr; });
         ++octave)
      for (std::size_t i = 0; i < active.size(); ++i) {
        if (!active[i]) continue;
        if (octave == 0) warm_up(study_.series[i], *active[i]);
        measure(study_.series[i], octave, *active[i]);
        if (study_.interrupted) return;
        const double seconds = study_.series[i].points.back().seconds;
        used[i] += seconds;
        if (used[i] + 2.0 * seconds > share || (1u << octave) >= kMostSamples) active[i] = nullptr;
      }
  }

  // Whatever comes first also pays for what drivers put off until then.
  void warm_up(const Series& series, KernelCompiler& kernels) {
    RenderSettings settings = series.configuration.settings;
    settings.last_sample = 1;
    render_one(settings, kernels, series.configuration.name());
  }

  // Every point has a seed of its own: their errors are then independent, as the interval of a slope supposes.
  void measure(Series& series, std::uint32_t octave, KernelCompiler& kernels) {
    RenderSettings settings = series.configuration.settings;
    settings.last_sample = 1u << octave;
    settings.seed = settings_.render.seed + octave;
    RenderResult result = render_one(settings, kernels, series.configuration.name());
    if (study_.interrupted) return;
    const Picture& reference = study_.reference.picture;
    StudyPoint point{result.spp, settings.seed, result.seconds, result.gpu_seconds, result.rays.total(), {}, 0.0, {}};
    point.metrics = compare_pictures(result.picture, reference);
    std::vector<float> flip = hdr_flip(result.picture, reference);
    point.flip = std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(flip.size());
    point.estimated_error = estimated_error(result);
    series.pictures.push_back({series.points.size(), std::move(result.picture), std::move(flip)});
    if (series.pictures.size() > kPicturesKept) series.pictures.erase(series.pictures.begin());
    series.points.push_back(point);
  }

  Device& device_;
  const StudyScene& scene_;
  const StudySettings& settings_;
  const StudyCallback& progress_;
  Study study_;
  double seconds_ = 0.0; // rendering so far
};

} // namespace

double StudyPoint::relative_rms() const { return std::sqrt(metrics.relmse); }

Study run_study(Device& device, const StudyScene& scene, const StudySettings& settings,
                std::optional<StudyReference> reference, const StudyCallback& progress) {
  return StudyRun(device, scene, settings, progress).run(std::move(reference));
}

} // namespace wavepath
