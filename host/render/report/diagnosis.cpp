#include "host/render/report/diagnosis.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/render/lost_light.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

// The part of the squared error that one sample may explain alone. With error probes, a sample of a probed pixel counts
// for its block, which the interval allows for: up to 0.1 on the Cornell box (320x240, 64 samples), from 0.2 on with
// fireflies.
constexpr double kLargestFraction = 0.05, kLargestFractionWithProbes = 0.15;
constexpr std::uint32_t kFewestSamples = 8; // a pixel, below which much has not been seen yet
constexpr double kFlat = -0.3;              // slope against spp; Monte Carlo's is -0.5
constexpr double kUnexplained = 1.5;        // true error over the upper end of the estimate

std::string percent(double x) { return fmt::format("{:.2g} %", 100.0 * x); }

bool fell_as_it_should(const std::vector<Checkpoint>& checkpoints) {
  return checkpoints.size() < 5 || fit_slope(checkpoints, Against::spp) <= kFlat;
}

bool has_fireflies(const RenderResult& result) {
  const bool whole = result.film && result.film->has_probes;
  return result.error.largest_sample_fraction > (whole ? kLargestFractionWithProbes : kLargestFraction);
}

} // namespace

bool is_trusted(const RenderResult& result) {
  return has_estimate(result.spp, result.error) && result.spp >= kFewestSamples && !result.nonfinite.first &&
         !has_fireflies(result);
}

std::string firefly_remedy(const RenderPlan& settings, const PackedScene& scene) {
  const IntegratorKind& kind = *settings.integrator;
  if (supports(kind, "direct") && settings.direct != gpu::kDirectMis) return "try --direct mis";
  const auto fits = [&](const IntegratorKind* other) {
    return other->splats && (!other->unsupported_reason || other->unsupported_reason(settings, scene).empty());
  };
  const auto finder = std::ranges::find_if(integrators(), fits);
  if (!kind.splats && kind.finds_light && finder != integrators().end() && has_smooth_surface(scene))
    return fmt::format(
        "try --integrator {}, without flags of {} alone: it follows light from lamps through glass and "
        "off mirrors",
        (*finder)->name, kind.name);
  if (supports(kind, "guide") && !settings.guide) return "try --guide, which learns where light comes from";
  return "look for small bright lights that are only found by chance";
}

std::vector<std::string> diagnose(const RenderPlan& settings, const PackedScene& scene, const RenderResult& result,
                                  const std::vector<TrueError>& true_errors, const std::vector<std::string>& bias) {
  std::vector<std::string> words;
  const ErrorEstimate& error = result.error;
  if (!has_estimate(result.spp, error)) {
    words.push_back(fmt::format("too few samples to estimate the error; it takes {} a pixel", gpu::kReplicates));
    return words;
  }
  if (result.spp < kFewestSamples)
    words.push_back(fmt::format("{} samples a pixel may have missed what is rare", result.spp));
  if (has_fireflies(result))
    words.push_back(
        fmt::format("fireflies: the largest sample alone explains {} of the squared error, so the estimate depends on "
                    "few samples; {}",
                    percent(std::min(error.largest_sample_fraction, 1.0)), firefly_remedy(settings, scene)));
  if (result.nonfinite.first)
    words.push_back(
        fmt::format("{} samples were not finite and are missing from the mean", result.nonfinite.samples()));
  if (!fell_as_it_should(result.checkpoints))
    words.push_back(fmt::format(
        "the estimated error falls too slowly (slope {:.2f} against samples, where noise alone gives -0.5): "
        "rare bright samples are still being found",
        fit_slope(result.checkpoints, Against::spp)));
  if (true_errors.size() != result.checkpoints.size() || !true_errors.back().metrics.finite()) return words;
  const double true_rms = std::sqrt(true_errors.back().metrics.relmse);
  if (true_rms > kUnexplained * error.ci95[1])
    words.push_back(fmt::format(
        "the true error, {}, is more than the noise, {}, explains: {}; or the reference was rendered with other "
        "settings, or is itself as noisy as that",
        percent(true_rms), percent(error.relative_rms),
        bias.empty() ? "nothing biased is known to be in force"
                     : fmt::format("in force are: {}", fmt::join(bias, "; "))));
  return words;
}

} // namespace wavepath
