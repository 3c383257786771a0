// Temporal upscaling (Karis 2014; Yang, Liu and Salvi 2020): frames of half the size, joined at the picture's.
#include <array>

#include "host/base/error.h"
#include "host/integrators/hybrid/antialias/kinds.h"
#include "kernels/hybrid/antialias/upscale.spv.h"

namespace wavepath {
namespace {

const std::array<KernelCode, 1> kUpscalePasses = {{{"upscale", wavepath_upscale_spv}}};

// Refuses the parts of frames that have one value for each pixel of the picture.
void refuse_parts_of_frames(const RenderPlan& settings) {
  const auto refuse = [](const char* flag) {
    throw UsageError(flag, "is not supported by --antialias upscale, whose frames have a quarter of the pixels",
                     "leave out one of them");
  };
  if (!settings.aovs.empty()) refuse("--aov");
  if (settings.reflections != 0) refuse("--reflections");
  if (settings.bounce != 0) refuse("--bounce");
}

} // namespace

const AntialiasKind kAntialiasUpscale = {
    .name = "upscale",
    .summary = "frames of half the size in each direction, joined at the picture's size (after Karis 2014)",
    .passes = kUpscalePasses,
    .over_time = true,
    .halves = true,
    .check = refuse_parts_of_frames};

} // namespace wavepath
