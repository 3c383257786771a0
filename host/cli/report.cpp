// Reports a finished render to the user.
#include "host/cli/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/memory.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/progress.h"
#include "host/film/error.h"
#include "host/session/judge.h"

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

} // namespace

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
