#include "host/render/agreement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "host/render/pilot_picture.h"
#include "host/render/settings/cover.h"
#include "host/render/settings/integrator_kind.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kAgreementSide = 64, kAgreementSamples = 16, kConfirmingSamples = 64;
constexpr double kSureErrors = 4.0, kLeastGap = 0.01;
constexpr std::size_t kBlocks = 4; // along each side

} // namespace

bool folds_mirrors(const PackedScene& scene) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const gpu::Material& m = scene.materials[i];
    if (m.normal_texture == gpu::kNone) continue;
    const bool coated = i < scene.layers.size() && scene.layers[i].coat > 0.0f;
    if (coated || m.metallic_roughness_texture != gpu::kNone || m.roughness * m.roughness < gpu::kMinAlpha) return true;
  }
  return false;
}

std::optional<Disagreement> find_disagreement(Device& device, const PackedScene& scene, const View& view,
                                              const RenderPlan& first, const RenderPlan& second,
                                              KernelCompiler& kernels, SceneOnDevice& shared) {
  if (folds_mirrors(scene)) return std::nullopt;
  const auto gap_at = [&](std::uint32_t samples, std::uint32_t seed) -> std::optional<Disagreement> {
    std::array<PictureLight, 2> light;
    for (std::size_t i = 0; i < 2; ++i) {
      RenderPlan once = without_cover(pilot_settings(i == 0 ? first : second, kAgreementSide, samples));
      once.max_depth = std::min(once.max_depth, 1u);
      once.guide = false, once.reuse = kReuseOff; // both training and reuse begin at the second bounce
      once.seed = first.seed ^ seed;
      once.aovs.clear();
      // The kernels of the render serve, which may pass panes where there are bounces left.
      if (once.integrator->passes_panes)
        once.kernels.added |= scene.features & (gpu::kFeaturePanes | gpu::kFeatureWalls);
      once.training.found = shared.light_probabilities;
      light[i] = light_of(*render(device, scene, view, once, RenderHooks{}, kernels, &shared).film);
    }
    const double most = std::max(light[0].sum, light[1].sum), gap = light[1].sum - light[0].sum;
    const double error = std::sqrt(light[0].variance + light[1].variance);
    if (std::abs(gap) <= kSureErrors * error || std::abs(gap) <= kLeastGap * most) return std::nullopt;
    return Disagreement{gap / most, error / most};
  };
  const std::optional<Disagreement> once = gap_at(kAgreementSamples, 0x51ed270bu);
  if (!once) return std::nullopt;
  const std::optional<Disagreement> again = gap_at(kConfirmingSamples, 0x2545f491u);
  return again && (again->fraction > 0.0) == (once->fraction > 0.0) ? again : std::nullopt;
}

bool differ_both_ways(const Film& a, const Film& b) {
  struct Block {
    double gap = 0.0, variance = 0.0;
  };
  std::array<Block, kBlocks * kBlocks> blocks{};
  // Pixels that share samples err alike, at most as if the four of a quad were one.
  const double ours_alike = a.quads ? gpu::kQuadPixels : 1.0, theirs_alike = b.quads ? gpu::kQuadPixels : 1.0;
  for (std::size_t y = 0; y < a.height; ++y)
    for (std::size_t x = 0; x < a.width; ++x) {
      const std::size_t i = y * a.width + x;
      const PixelStatistics ours = statistics(a, i), theirs = statistics(b, i);
      Block& block = blocks[y * kBlocks / a.height * kBlocks + x * kBlocks / a.width];
      for (int c = 0; c < 3; ++c) {
        block.gap += ours.mean[c] - theirs.mean[c];
        block.variance += ours_alike * ours.variance[c] + theirs_alike * theirs.variance[c];
      }
    }
  const auto any = [&](double side) {
    return std::ranges::any_of(blocks, [&](const Block& block) {
      return side * block.gap > kSureErrors * std::sqrt(block.variance) && block.gap != 0.0;
    });
  };
  return any(1.0) && any(-1.0);
}

} // namespace wavepath
