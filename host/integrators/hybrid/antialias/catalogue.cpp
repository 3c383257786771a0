#include "host/integrators/hybrid/antialias/catalogue.h"

#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/integrators/hybrid/antialias/kinds.h"
#include "host/render/settings/antialias_settings.h"
#include "kernels/hybrid/hybrid_types.h"

namespace wavepath {
namespace {

constexpr std::array kKinds = {&kAntialiasFilter, &kAntialiasNone, &kAntialiasSupersample, &kAntialiasFxaa,
                               &kAntialiasSmaa,   &kAntialiasTaa,  &kAntialiasMsaa};
static_assert(kKinds.size() == kAntialiasNames.size());

} // namespace

std::span<const AntialiasKind* const> antialias_kinds() { return kKinds; }

const AntialiasKind& antialias_kind(const RenderPlan& settings) { return *kKinds[settings.antialias]; }

std::uint32_t whole_samples(const RenderPlan& settings) {
  return settings.sample_total > 0 ? settings.sample_total : settings.last_sample;
}

void check_antialias_settings(const RenderPlan& settings) {
  const AntialiasKind& kind = antialias_kind(settings);
  const std::string flag = fmt::format("--antialias {}", kind.name);
  const bool usual_filter = settings.filter == RenderPlan{}.filter || settings.filter == gpu::kFilterBox;
  if (kind.place && !usual_filter)
    throw UsageError("--filter", fmt::format("is not taken by {}", flag), "leave it out");
  const std::uint32_t samples = whole_samples(settings);
  const auto side = static_cast<std::uint32_t>(std::lround(std::sqrt(static_cast<double>(samples))));
  if (kind.wants_square && side * side != samples)
    throw UsageError(flag, fmt::format("has a grid of NxN places, and {} samples make none", samples),
                     fmt::format("give --spp {}", side * side));
  if (!kind.shares_shading) return;
  if (samples % gpu::kSharingPlaces != 0)
    throw UsageError(flag, fmt::format("has {} places a pixel, and {} samples fill none", gpu::kSharingPlaces, samples),
                     fmt::format("give --spp {}", (samples / gpu::kSharingPlaces + 1) * gpu::kSharingPlaces));
  if (settings.target_error > 0.0)
    throw UsageError("--target-error", fmt::format("is not taken by {}, whose samples share their noise", flag),
                     "leave it out");
}

} // namespace wavepath
