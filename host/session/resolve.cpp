#include "host/session/resolve.h"

#include <algorithm>
#include <sstream>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/film/error.h"
#include "host/gpu/context.h"
#include "host/gpu/device_choice.h"
#include "host/picture/filter/oidn.h"
#include "host/plan/adaptive.h"
#include "host/plan/plan.h"
#include "host/render/settings/antialias_settings.h"
#include "host/render/settings/crop.h"
#include "host/render/settings/denoising.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/settings_table.h"
#include "host/render/workspace/levels.h"

namespace wavepath {
namespace {

[[noreturn]] void refuse_unsupported(const std::string& flag, const RenderPlan& settings,
                                     const std::string& supported_by) {
  throw UsageError(flag, fmt::format("is not supported by --integrator {}", name_of(settings.integrator)),
                   fmt::format("use --integrator {}, or leave it out", supported_by));
}

void resolve_devices(RenderRequest& request) {
  if (request.devices.empty()) return;
  const auto refuse = [&](bool given, const char* flag, const char* why) {
    if (given)
      throw UsageError("--devices", fmt::format("does not go with {}, {}", flag, why), "leave out one of them");
  };
  refuse(!request.device.empty(), "--device", "which names one");
  refuse(!request.state.file.empty(), "--checkpoint", "whose state is that of one device");
  refuse(request.settings.adaptive == kAdaptiveOn, "--adaptive", "whose samples are not shared out evenly");
  refuse(request.pixel.has_value(), "--pixel", "which renders one path");
  const std::vector<DeviceInfo> known = list_devices();
  std::vector<std::string> wanted;
  if (request.devices == "all") {
    const auto usable = [&](bool cpu) {
      for (std::size_t i = 0; i < known.size(); ++i)
        if (known[i].missing.empty() && (known[i].type == "cpu") == cpu) wanted.push_back(std::to_string(i));
    };
    usable(false);
    if (wanted.empty()) usable(true);         // beside a GPU a CPU would have to be waited for
    if (wanted.empty()) wanted.push_back(""); // says what is missing
  } else {
    std::istringstream list(request.devices);
    for (std::string one; std::getline(list, one, ',');)
      if (!one.empty()) wanted.push_back(std::to_string(choose_device(known, one)));
    if (wanted.empty()) throw UsageError("--devices", "names no device", "write --devices 0,1 or --devices all");
  }
  request.device = wanted.front();
  request.other_devices.assign(wanted.begin() + 1, wanted.end());
}

void resolve_strict(RenderRequest& request) {
  if (!request.strict) return;
  if (is_given(request, "techniques") && request.settings.techniques & gpu::kTechniqueMerge)
    throw UsageError("--strict", "refuses merging, which blurs", "leave merge out of --techniques");
  request.settings.techniques &= ~gpu::kTechniqueMerge;
}

// Pixels that the picture does not have, and what a part of it cannot tell.
void check_crop(const RenderPlan& settings) {
  if (!settings.crop) return;
  const Crop& crop = *settings.crop;
  if (std::uint64_t{crop.left} + crop.width > settings.width || std::uint64_t{crop.top} + crop.height > settings.height)
    throw UsageError("--crop",
                     fmt::format("{},{},{},{} is not within the picture of {}x{}", crop.left, crop.top, crop.width,
                                 crop.height, settings.width, settings.height),
                     "give X,Y,WIDTH,HEIGHT within --size, which is that of the whole picture");
  if (settings.denoise != kDenoiseOff)
    throw UsageError("--denoise", "looks at neighbours that a part of a picture lacks",
                     "leave out --crop, or filter the merged picture");
  if (settings.target_error == 0.0) return;
  RenderPlan possible = settings; // pilots may decide later whether paths are reused, which moves the probes
  for (const auto reuse : {kReuseOff, kReuseOn}) {
    possible.reuse = reuse;
    const FilmShape shape = picture_shape(possible);
    if (shape.has_probes && probes_within(shape) < kFewestProbes)
      throw UsageError("--target-error", "needs more pixels than --crop has, for an estimate of the error",
                       "give --spp instead, or a larger part");
  }
}

// Decisions that would not be taken.
void check_plan(const RenderRequest& request) {
  const char* given = request.training_paths     ? "--training-paths"
                      : request.guide_iterations ? "--guide-iterations"
                                                 : nullptr;
  if (given && !stands_alone(request))
    throw UsageError(given, "parts of a render train alike, whatever their length", "leave it out");
  if (!request.plan_file.empty() && request.state.resume)
    throw UsageError("--plan", "the state of --resume holds a plan of its own", "leave out one of them");
}

// Throws UsageError where a path is to be replayed that the render does not have.
void check_replay(const RenderRequest& request) {
  const RenderPlan& settings = request.settings;
  if (request.pixel.has_value() != request.sample.has_value())
    throw UsageError(request.pixel ? "--pixel" : "--sample", "names no path alone", "give --pixel X,Y and --sample N");
  if (!request.pixel) {
    if (request.replicate != 0)
      throw UsageError("--net", "names no path alone", "give --pixel X,Y and --sample N as well");
    return;
  }
  if (settings.guide)
    throw UsageError("--pixel", "replays paths without a guiding field, which are others", "leave out --guide");
  if (request.pixel->x >= settings.width || request.pixel->y >= settings.height)
    throw UsageError(
        "--pixel",
        fmt::format("{},{} is outside the picture of {}x{}", request.pixel->x, request.pixel->y, settings.width,
                    settings.height),
        fmt::format("stay within {},{}, or give the --size of the render", settings.width - 1, settings.height - 1));
  // Noisy pixels of an adaptive render have more samples than --spp.
  const bool may_have_more = settings.adaptive == kAdaptiveOn || may_pay_adaptive(settings);
  const std::uint64_t end = std::uint64_t{settings.last_sample} * (may_have_more ? kHighestFactor : 1);
  if (*request.sample < settings.first_sample || *request.sample >= end)
    throw UsageError("--sample", fmt::format("{} is not in {}:{}", *request.sample, settings.first_sample, end),
                     "give the --spp or --samples of the render");
}

} // namespace

bool stands_alone(const RenderRequest& request) { return !request.mergeable && request.devices.empty(); }

void resolve_samples(RenderRequest& request) {
  RenderPlan& settings = request.settings;
  if (request.state.resume && request.state.file.empty())
    throw UsageError("--resume", "there is nothing to resume from", "name the state with --checkpoint FILE");
  const bool part = is_given(request, "samples");
  if (settings.adaptive == kAdaptiveOn && (part || request.mergeable))
    throw UsageError("--adaptive", "does not share its samples out evenly, so parts of it cannot be merged",
                     "leave out --adaptive, or --samples and --mergeable");
  request.mergeable |= part;
  // Parts of one render give its --spp, so that they share its strata.
  const std::uint32_t spp = settings.sample_total; // 0 = not given
  if (part && spp > 0 && settings.last_sample > spp)
    throw UsageError("--samples", fmt::format("{} ends beyond --spp {}", settings.last_sample, spp),
                     "give a range within 0:spp");
  if (part) return;
  const bool open_ended = settings.time_limit > 0.0 || settings.target_error > 0.0;
  settings.last_sample = spp > 0 ? spp : open_ended ? kOpenEndedSamples : settings.last_sample;
  settings.sample_total = 0;
}

void resolve_integrator(RenderRequest& request) {
  RenderPlan& settings = request.settings;
  RenderPlan automatic = settings;
  automatic.integrator = IntegratorSetting::automatic();
  const bool lone_part = is_given(request, "samples") && settings.sample_total == 0;
  const bool refuses_flag = std::ranges::any_of(settings_table(), [&](const Setting& row) {
    return row.supported_by == SupportedBy::listed_else_refused && !is_supported(row, automatic) &&
           !is_default(row, settings);
  });
  const bool refuses_aov = std::ranges::any_of(settings.aovs, [&](const std::string& aov) {
    return !aov_supporters_text(aov).empty() && std::ranges::count(automatic.integrator->aovs, aov) == 0;
  });
  const bool replays = request.pixel.has_value() && !supports(automatic.integrator, "pixel");
  const bool asks_for_path = settings.reuse == kReuseOn; // which other integrators would drop
  if (is_given(request, "integrator") || lone_part || refuses_flag || refuses_aov || replays || asks_for_path) return;
  settings.integrator = automatic.integrator;
}

void check_integrator(const RenderRequest& request) {
  const RenderPlan& settings = request.settings;
  const IntegratorKind& kind = *settings.integrator;
  for (const Setting& row : settings_table())
    if (row.supported_by == SupportedBy::listed_else_refused && !is_supported(row, settings) &&
        !is_default(row, settings))
      refuse_unsupported(fmt::format("--{}", row.name), settings, supporters_text(row.name));
  if (kind.check) kind.check(settings);
  for (const std::string& aov : settings.aovs)
    if (const std::string supported_by = aov_supporters_text(aov);
        !supported_by.empty() && std::ranges::count(kind.aovs, aov) == 0)
      refuse_unsupported("--aov " + aov, settings, supported_by);
  const auto is_followed = [](const std::string& aov) { return aov == "albedo" || aov == "normal"; };
  if (settings.aov_through && std::ranges::none_of(settings.aovs, is_followed) && !denoises_film(settings))
    throw UsageError("--aov-through", "means nothing without the channels albedo and normal",
                     "add --aov albedo,normal or --denoise, or leave it out");
  for (const std::string_view aov : kind.lacks_aovs)
    if (std::ranges::count(settings.aovs, aov) > 0)
      throw UsageError(fmt::format("--aov {}", aov),
                       fmt::format("cannot be told apart by --integrator {}", name_of(settings.integrator)),
                       "leave it out, or use --integrator path");
  if (request.pixel && !supports(settings.integrator, "pixel"))
    refuse_unsupported("--pixel", settings, supporters_text("pixel"));
  if (request.strict && kind.is_biased(settings))
    throw UsageError(fmt::format("--integrator {}", name_of(settings.integrator)), "is biased, which --strict refuses",
                     settings.denoise      ? "leave out --denoise"
                     : uses_mips(settings) ? "use --integrator path, or --max-depth 1 --mips off for direct light"
                                           : "use --integrator path, or --max-depth 1 for direct light");
  if (request.strict && settings.clamp > 0.0)
    throw UsageError("--clamp", "is biased, which --strict refuses", "leave it out");
  if (request.strict && settings.textures == kTexturesHardware)
    throw UsageError("--textures hardware", "is biased, which --strict refuses", "leave it out");
  const bool splits = request.mergeable || !request.state.file.empty() || !request.devices.empty();
  const auto refuse_history = [](const char* flag) {
    throw UsageError(flag, "makes every sample depend on those before, and no file keeps that history",
                     "leave it out, or --checkpoint, --samples, --mergeable and --devices");
  };
  if (splits && settings.denoise != kDenoiseOff && !denoises_film(settings)) refuse_history("--denoise");
  if (splits && settings.antialias == kAntialiasTaaName) refuse_history("--antialias taa");
  if (splits && settings.antialias == kAntialiasUpscaleName) refuse_history("--antialias upscale");
  if (request.strict && denoises_film(settings))
    throw UsageError("--denoise", "is biased, which --strict refuses", "leave out --denoise");
  if (settings.denoise != kDenoiseOidn) return;
  if (!denoises_film(settings))
    throw UsageError("--denoise oidn",
                     fmt::format("cannot filter the frames of --integrator {}", name_of(settings.integrator)),
                     "use --denoise alone, or --integrator path");
  require_oidn();
}

void resolve_settings(const SceneRequest& scene, RenderRequest& request) {
  check_volume(scene.volume);
  check_catcher(scene, request.settings);
  resolve_samples(request);
  resolve_integrator(request);            // by the samples
  check_shutter(scene, request.settings); // which the integrator's own check asks about
  check_integrator(request);
  check_camera(scene.view, request.settings);
  check_crop(request.settings);
  resolve_strict(request);
  resolve_devices(request);
  check_plan(request);
  const bool repeats = !request.plan_file.empty() || request.pixel;
  foresee(request.settings, repeats ? Policy::rules : Policy::pilots, stands_alone(request));
  check_replay(request);
}

} // namespace wavepath
