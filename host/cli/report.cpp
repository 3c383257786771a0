// Reports a finished render to the user.
#include "host/cli/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <numeric>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/memory.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/progress.h"
#include "host/film/error.h"
#include "host/film/film.h"
#include "host/render/report/lamp_extents.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "kernels/base/tile_order.h"

namespace wavepath {
namespace {

std::string halving_text(const RenderResult& result) {
  const double growth = growth_for(2.0, result.slope);
  if (!(result.error.relative_rms > 0.0) || !std::isfinite(growth)) return {};
  return fmt::format("; half of this error takes about {} more", duration_text(result.seconds * (growth - 1.0)));
}

void print_summary(const Run& run, const OutputRequest& output) {
  const RenderResult& result = run.result;
  const double speed = result.seconds > 0.0 ? 1e-6 * static_cast<double>(result.rays.total()) / result.seconds : 0.0;
  std::string error;
  if (const auto estimate = estimated_error(result))
    error = fmt::format(", estimated error {:.3g} % ({:.3g} to {:.3g})", 100.0 * *estimate,
                        100.0 * result.error.ci95[0], 100.0 * result.error.ci95[1]) +
            halving_text(result);
  const bool shared_out = result.noise && result.noise->used;
  print_err("wavepath: {}: {} spp{} in {:.2f} s, {:.2f} Mrays/s{}\n", written_text(output, result.picture), result.spp,
            shared_out ? ", more where there is noise," : "", result.seconds, speed, error);
}

void print_shadows(const ShadowReport& shadows) {
  print_err("  shadows     {} views, {}", shadows.views, to_size_text(shadows.bytes));
  if (const auto& answers = shadows.answers) {
    const std::uint64_t all = std::max<std::uint64_t>(answers->answered + answers->traced, 1);
    print_err("; {} look-ups, {:.3g} % of them left to rays", all,
              100.0 * static_cast<double>(answers->traced) / static_cast<double>(all));
  }
  print_err("\n");
}

void print_details(const Run& run) {
  const RenderResult& result = run.result;
  print_err("  device      {} ({}, {})\n", run.device.name, run.device.driver, run.device.type);
  for (const DeviceWork& work : run.shared ? run.shared->device_work : std::vector<DeviceWork>{})
    print_err("  shares      {}: {} samples in {:.2f} s{}\n", work.name, work.samples(), work.seconds,
              work.lost ? ", then lost" : "");
  print_err("  scene       {} triangles, {} lights\n", run.packed.triangle_count, run.packed.lights.size());
  if (const CutCounts& cut = run.packed.cut; cut.triangles > 0)
    print_err("  cut         {} triangles that are huge beside their distance to the eye, into {} pieces\n",
              cut.triangles, cut.pieces);
  print_err("  memory      {} on the device at most: scene {}, BVH {}, paths {}, film {}\n",
            to_size_text(run.peak_bytes), to_size_text(result.memory.scene), to_size_text(result.memory.bvh),
            to_size_text(result.memory.paths), to_size_text(result.memory.film));
  print_err(
      "  seconds     load {:.2f}, BVH {:.2f}, upload {:.2f}, compile {:.2f}, render {:.2f}, write {:.2f}; first "
      "pixel after {:.2f}\n",
      run.load_seconds, run.packed.bvh_seconds, result.upload_seconds, result.compile_seconds, result.seconds,
      run.write_seconds, result.first_pixel_seconds);
  print_err("  kernels     cache {}\n", run.kernel_cache);
  if (result.by_query) print_err("  traversal   by the device's ray queries\n");
  print_err("  rays        camera {}, bounce {}, shadow {}, occlusion {}\n", result.rays.camera, result.rays.bounce,
            result.rays.shadow, result.rays.occlusion);
  if (result.noise)
    print_err("  samples     {}; levels are expected to take {:.2g} of the cost of a given error\n",
              result.noise->used ? "shared out by noise" : "even, as noise is", result.noise->cost);
  if (result.shadows) print_shadows(*result.shadows);
  for (const StageTime& stage : result.stages)
    print_err("  {:<12}{:.3f} s in {} dispatches\n", stage.name, stage.seconds, stage.dispatches);
  for (const LeftOut& entry : run.packed.left_out)
    print_err("  left out    {}: {} ({})\n", entry.what, entry.why, to_size_text(entry.bytes));
}

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

void write_pictures(OutputRequest& output, const PictureInfo& info, const Picture& picture, Warnings& warnings,
                    Attempts& attempts) {
  std::erase_if(output.pictures, [&](const std::string& path) {
    return !attempts.attempt([&] {
      const std::uint64_t clamped = write_picture(path, picture, info, output.write);
      if (clamped > 0) warnings.add(path + ": value clamped to what the format holds", clamped);
    });
  });
}

std::string written_text(const OutputRequest& output, const Picture& picture) {
  const auto is_tonemapped = [](const std::string& path) {
    const std::optional<PictureFormat> format = picture_format(path);
    return format == PictureFormat::png || format == PictureFormat::jpg;
  };
  const std::string exposure = std::ranges::any_of(output.pictures, is_tonemapped)
                                   ? fmt::format(" (exposure {:+.2f})", exposure_of(picture, output.write))
                                   : "";
  std::string text;
  for (const std::string& path : output.pictures)
    text += (text.empty() ? "" : ", ") + path + (is_tonemapped(path) ? exposure : "");
  return text.empty() ? "nothing written" : text;
}

TrueError measure_true_error(const Picture& picture, const Picture& reference) {
  TrueError error{compare_pictures(picture, reference), 0.0};
  if (!error.metrics.finite()) return error;
  const std::vector<float> flip = hdr_flip(picture, reference);
  error.flip = std::accumulate(flip.begin(), flip.end(), 0.0) / static_cast<double>(flip.size());
  return error;
}

void report(const Run& run, const OutputRequest& output, Warnings warnings, const std::string& document,
            Attempts& attempts) {
  const RenderResult& result = run.result;
  if (result.nonfinite.first)
    warnings.add("non-finite sample left out, " + describe_first(result.nonfinite, run.settings),
                 result.nonfinite.samples());
  if (result.spp == 0) warnings.add("stopped within the first sample; pixels that it had not reached are black");
  if (result.shadows && !result.shadows->smaller.empty()) warnings.add(result.shadows->smaller);
  const TrueError* last = run.true_errors.empty() ? nullptr : &run.true_errors.back();
  if (last && !last->metrics.finite()) warnings.add(output.reference + ": not compared, a value is not finite");
  print_warnings(warnings);

  if (output.json && !document.empty())
    attempts.attempt([&] {
      write_out(document);
      flush_out();
    });
  if (output.quiet) return;
  print_summary(run, output);
  if (last && last->metrics.finite())
    print_err("wavepath: against {}: relMSE {:.6g}, MSE {:.6g}, MRSE {:.6g}, FLIP {:.4f}\n", output.reference,
              last->metrics.relmse, last->metrics.mse, last->metrics.mrse, last->flip);
  if (result.denoised) print_err("wavepath: denoised in {:.2f} s\n", result.denoised->seconds);
  if (run.denoised_error && run.denoised_error->metrics.finite())
    print_err("wavepath: denoised, against {}: relMSE {:.6g}, MSE {:.6g}, MRSE {:.6g}, FLIP {:.4f}\n", output.reference,
              run.denoised_error->metrics.relmse, run.denoised_error->metrics.mse, run.denoised_error->metrics.mrse,
              run.denoised_error->flip);
  for (const std::string& sentence : run.diagnosis) print_err("wavepath: note: {}\n", sentence);
  if (output.verbose) print_details(run);
}

} // namespace wavepath
