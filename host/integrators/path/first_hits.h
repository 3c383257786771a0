// First hits of camera rays, traced apart from a render: what passes through the pixel's centre, and coverages, are
// made of (host/passes).
#pragma once

#include <cstdint>
#include <functional>
#include <span>

#include "host/render/loop/hooks.h"
#include "host/render/render.h"
#include "host/scene/staging/view.h"
#include "kernels/film/film_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

// Of one camera ray.
struct FirstHit {
  std::uint32_t pixel = 0; // row-major from the top left
  gpu::Ray ray;            // in the device's world
  gpu::Hit hit;            // its triangle is kNone if the ray left the scene
  gpu::PathAovs surface{}; // as AOVs have it, where it was asked for
};

enum class HitData { geometry, surface };

// Which rays: one through the middle of every pixel, without lens and shutter (its moment is when that opens); or those
// of all samples of a path-traced picture, first_sample <= s < last_sample of every pixel.
enum class RaysThrough { centres, samples };

// Traces the rays of all pixels and calls `visit` for as many at a time as are in flight. Hits on surfaces with alpha
// are those of that sample's path, of centres those of sample 0. `progress`: false ends it, as visits so far tell;
// returns whether all were visited. Throws Error if the device fails.
bool trace_first_hits(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                      RaysThrough through, HitData data, KernelCompiler& kernels, SceneOnDevice& shared,
                      const std::function<bool()>& progress,
                      const std::function<void(std::span<const FirstHit>)>& visit);

} // namespace wavepath
