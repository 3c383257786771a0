#include "host/session/judge.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include "host/film/film.h"
#include "host/render/report/lamp_extents.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

// "1.8 % +- 0.3 %", "100 % +- 2 %".
std::string percent_text(double fraction, double error) {
  const auto text = [](double percent, int digits) { // those that count, and none after an exponent
    return percent < std::pow(10.0, digits) - 0.5 ? fmt::format("{:.{}g}", percent, digits)
                                                  : fmt::format("{:.0f}", percent);
  };
  return fmt::format("{} % +- {} %", text(100.0 * fraction, 2), text(100.0 * error, 1));
}

// The change of the scene that --sun-angle and --lamp-radius make; empty = none.
std::string soft_lamps_text(const PackedScene& scene) {
  const LampExtents extents = lamp_extents(scene);
  std::vector<std::string> changes;
  if (extents.sun_degrees > 0.0)
    changes.push_back(
        fmt::format("directional lights are seen under {:.3g} degrees (--sun-angle)", extents.sun_degrees));
  if (extents.radius > 0.0)
    changes.push_back(
        fmt::format("point and spot lights are spheres of radius {:.3g} m (--lamp-radius)", extents.radius));
  if (changes.empty()) return {};
  return fmt::format("the scene is changed, with the light that its lamps have: {}", fmt::join(changes, ", "));
}

constexpr const char* kClampText = "samples are dimmed to a radiance of ";

std::string clamp_text(double radiance) { return fmt::format("{}{:g} (--clamp)", kClampText, radiance); }

std::string clamp_share_text(double radiance, const Film& film) {
  return fmt::format(", which took {:.2g} % of the light", 100.0 * clamped_fraction(film, radiance));
}

} // namespace

std::vector<std::string> list_bias(const RenderPlan& settings, const PackedScene& scene, const RenderResult& result,
                                   const MissingLight& missing) {
  const std::optional<DepthCut>& cut = missing.cut;
  const std::optional<LostLight>& lost = missing.lost;
  std::vector<std::string> bias = settings.integrator->bias(settings, result);
  if (!missing.no_cut.empty())
    bias.front() += fmt::format(": how much light is missing was not measured ({})", missing.no_cut);
  if (!missing.no_lost.empty())
    bias.push_back(
        fmt::format("light of lamps and suns through thick smooth glass and off mirrors may be missing: how much was "
                    "not measured ({})",
                    missing.no_lost));
  if (cut)
    bias.front() += fmt::format(": {} of the light is missing, measured to {} bounces",
                                percent_text(cut->fraction, cut->standard_error), cut->deeper);
  if (lost && lost->disagrees)
    bias.emplace_back(
        "path and bidirectional disagree on light that both find, after one bounce: one of them is wrong; please "
        "report "
        "this with the scene");
  else if (lost)
    bias.push_back(fmt::format(
        "light of lamps and suns through thick smooth glass and off mirrors is missing: {} of all light; --integrator "
        "bidirectional finds it",
        percent_text(lost->fraction, lost->standard_error)));
  if (const std::string unlit = unlit_bodies(scene); !unlit.empty() && settings.integrator->nests_bodies)
    bias.push_back(unlit);
  if (std::ranges::any_of(scene.lights, [](const gpu::Light& light) { return light.inverse_range > 0.0f; }))
    bias.emplace_back(
        "light of lamps with a `range` fades to nothing there, as viewers of glTF have it (KHR_lights_punctual)");
  if (const std::string soft = soft_lamps_text(scene); !soft.empty()) bias.push_back(soft);
  if (settings.clamp > 0.0 && result.film)
    bias.push_back(clamp_text(settings.clamp) + clamp_share_text(settings.clamp, *result.film));
  else if (settings.clamp > 0.0)
    bias.push_back(clamp_text(settings.clamp));
  if (settings.moving && supports(*settings.integrator, "shutter"))
    bias.emplace_back(
        "vertices move along straight lines while the shutter is open; camera and lamps stay (--shutter)");
  if (settings.cull == gpu::kCullAll && scene.features & gpu::kFeatureCull)
    bias.emplace_back("light passes single-sided surfaces from behind (--cull all)");
  if (!settings.integrator->nests_bodies && settings.integrator->finds_light && scene.features & gpu::kLobeNested)
    bias.push_back(
        fmt::format("bodies whose boxes meet are seen surface by surface, also where they overlap "
                    "(--integrator {}); --integrator path tells which of them is there",
                    settings.integrator->name));
  if (settings.terminator == gpu::kTerminatorSmooth && scene.features & gpu::kFeatureSmoothNormals)
    bias.emplace_back("rays leave meshes from the smooth surface that their normals stand for (--terminator smooth)");
  if (uses_mips(settings) && scene.features & gpu::kFeatureMips)
    bias.emplace_back("textures are looked up at mip levels, as a pixel has one sample (--mips)");
  if (scene.features & gpu::kFeatureSampledTextures)
    bias.emplace_back(
        "textures are filtered by the device's samplers, whose weights have few bits, usually 8 (--textures hardware)");
  if (result.denoised && denoises_film(settings))
    bias.emplace_back(
        "the channels denoised.R,G,B of .exr files, and all of other files, are filtered: detail that is "
        "smaller than the noise is lost (--denoise)");
  if (result.nonfinite.first)
    bias.push_back(fmt::format("{} samples that were not finite are left out", result.nonfinite.samples()));
  return bias;
}

std::string with_clamp_share(const std::string& bias, const Film& film) {
  const std::size_t at = bias.find(kClampText);
  if (at == std::string::npos) return bias;
  const double radiance = std::strtod(bias.c_str() + at + std::strlen(kClampText), nullptr);
  const std::size_t end = std::min(bias.find(';', at), bias.size());
  return bias.substr(0, at) + clamp_text(radiance) + clamp_share_text(radiance, film) + bias.substr(end);
}

std::string describe_first(const Nonfinite& nonfinite, const RenderPlan& settings) {
  const NonfiniteSample& first = nonfinite.first.value();
  const glm::uvec2 at = gpu::pixel_in_tile_order(first.at.pixel, settings.width, settings.height);
  return fmt::format(
      "the first in pixel {},{}, sample {}{}, seed {}, made by {}; these flags and --pixel {},{} --sample {}{} --seed "
      "{} "
      "replay it",
      at.x, at.y, first.sample, first.at.replicate ? " of its second replicate" : "", settings.seed,
      kMakerNames[first.maker], at.x, at.y, first.sample, first.at.replicate ? " --net 1" : "", settings.seed);
}

TrueError measure_true_error(const Picture& picture, const Picture& reference) {
  TrueError error{compare_pictures(picture, reference), 0.0};
  if (!error.metrics.finite()) return error;
  const std::vector<float> flip = hdr_flip(picture, reference);
  error.flip = std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(flip.size());
  return error;
}

} // namespace wavepath
