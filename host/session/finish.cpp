#include "host/session/finish.h"

#include <algorithm>

#include "host/passes/passes.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/pass_names.h"

namespace wavepath {
namespace {

// Then there is no time, or no device, to find out more.
bool ended_early(const RenderResult& result) {
  return result.stop == StopReason::interrupted || result.stop == StopReason::device_lost;
}

// The first device that was not lost, for what is measured after the render.
RenderingDevice surviving(const Prepared& prepared, const MultiDeviceResult* shared) {
  for (std::size_t i = 1; shared && i < shared->device_work.size() && shared->device_work.front().lost; ++i)
    if (!shared->device_work[i].lost)
      return {prepared.others[i - 1].device.get(), prepared.others[i - 1].kernels.get()};
  return {prepared.device.get(), prepared.kernels.get()};
}

} // namespace

void add_passes_if_asked(Prepared& prepared, RenderResult& result, const MultiDeviceResult* shared,
                         const std::function<bool()>& goes_on) {
  RenderPlan settings = prepared.plan.settings;
  if (std::ranges::none_of(settings.aovs, is_pass)) return;
  settings.last_sample = settings.first_sample + std::max(result.spp, 1u);
  const RenderingDevice on = surviving(prepared, shared);
  SceneOnDevice elsewhere;
  SceneOnDevice& on_device = on.device == prepared.device.get() ? prepared.on_device : elsewhere;
  why_not_measured(prepared, "passes of --aov were", [&] {
    if (!add_passes(*on.device, prepared.packed, prepared.view, settings, prepared.motion, *on.kernels, on_device,
                    goes_on, result.picture))
      prepared.warnings.add("interrupted before all passes of --aov were found");
  });
}

MissingLight measure_missing_light(Prepared& prepared, const RenderResult& result, const MultiDeviceResult* shared,
                                   const std::function<bool()>& goes_on) {
  MissingLight missing;
  if (ended_early(result)) return missing;
  const RenderPlan& settings = prepared.plan.settings;
  const RenderingDevice on = surviving(prepared, shared);
  SceneOnDevice elsewhere;
  SceneOnDevice& on_device = on.device == prepared.device.get() ? prepared.on_device : elsewhere;
  const auto progress = [&](const Progress&) { return goes_on(); };
  constexpr const char* kWhat = "how much light is missing was";
  if (settings.integrator->measures_depth_cut) // its paths are cut
    missing.no_cut = why_not_measured(prepared, kWhat, [&] {
      missing.cut =
          measure_depth_cut(*on.device, prepared.packed, prepared.view, settings, *on.kernels, on_device, progress);
    });
  missing.no_lost = why_not_measured(prepared, kWhat, [&] {
    missing.lost =
        measure_lost_light(*on.device, prepared.packed, prepared.view, settings, *on.kernels, on_device, progress);
  });
  return missing;
}

} // namespace wavepath
