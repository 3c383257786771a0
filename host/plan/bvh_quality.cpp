#include "host/plan/bvh_quality.h"

#include <algorithm>

namespace wavepath {
namespace {

// Rays a triangle that pay for a quality. On two cores, spatial splits and reinsertion take 0.5 us a triangle more than
// none and save a seventh of the 0.5 us that a ray takes on average (from nothing on StanfordDragon to a third on
// Sponza); `best` takes 0.3 us more and saves less than another hundredth. See benchmarks/results/NOTES.md.
constexpr double kBalancedPays = 7.0, kBestPays = 100.0;

// A GPU traces rays so much faster than two cores, while the tree is built on the host all the same.
constexpr double kGpuSpeed = 250.0;
constexpr double kRaySeconds = 0.5e-6; // on two cores
// Of five bounces: 3 of DamagedHelmet, 4.5 of the showcase, 9 to 12 of Sponza and HotelRoom, by several shadow rays.
constexpr double kRaysPerSample = 6.0;

} // namespace

bvh::Quality choose_quality(const RenderPlan& settings, std::uint64_t triangles, const DeviceInfo& device) {
  const double speed = device.type == "cpu" ? 1.0 : kGpuSpeed;
  const double samples =
      static_cast<double>(settings.width) * settings.height * (settings.last_sample - settings.first_sample);
  double rays = kRaysPerSample * samples;
  if (settings.time_limit > 0.0) rays = std::min(rays, settings.time_limit * speed / kRaySeconds);
  const double rays_per_triangle = rays / (speed * static_cast<double>(std::max<std::uint64_t>(triangles, 1)));
  return rays_per_triangle >= kBestPays       ? bvh::Quality::best
         : rays_per_triangle >= kBalancedPays ? bvh::Quality::balanced
                                              : bvh::Quality::fast;
}

Decision decision_of(bvh::Quality quality) {
  return {.what = "bvh",
          .taken = std::string(kQualityNames[static_cast<std::size_t>(quality)]),
          .why = "rule: the rays of the render pay for it"};
}

} // namespace wavepath
