#include "host/bench/contest.h"

#include <algorithm>
#include <cmath>

#include "host/base/clock.h"

namespace wavepath {

std::array<std::size_t, kRayKindCount> count_rays(const RaySets& rays) {
  return {rays.camera.size(), rays.bounce.size(), rays.shadow.size()};
}

void take_turns(std::vector<Contestant>& contestants, std::uint32_t repetitions) {
  constexpr double kLongEnough = 0.03; // seconds
  for (std::size_t kind = 0; kind < kRayKindCount; ++kind) {
    std::uint32_t runs = 1;
    for (Contestant& each : contestants) { // the first time with what is prepared once
      if (each.seconds(static_cast<RayKind>(kind)) <= 0.0) continue;
      const Clock::time_point start = Clock::now();
      each.seconds(static_cast<RayKind>(kind));
      runs = std::max(runs, static_cast<std::uint32_t>(std::ceil(kLongEnough / std::max(seconds_since(start), 1e-4))));
    }
    for (std::uint32_t turn = 0; turn < repetitions; ++turn)
      for (Contestant& each : contestants) {
        double sum = 0.0;
        for (std::uint32_t i = 0; i < runs; ++i) sum += each.seconds(static_cast<RayKind>(kind));
        each.measured[kind].push_back(sum / runs);
      }
  }
}

Contestant replaying(RayReplay& replay, const RaySets& rays) {
  return {[&](RayKind kind) {
    if (count_rays(rays)[kind] == 0) return 0.0;
    if (kind == kShadowRaysKind) return replay.connect(rays.shadow);
    return replay.extend(kind == kCameraRays ? rays.camera : rays.bounce, kind == kCameraRays);
  }};
}

double agreement(const std::vector<float>& ours, const std::vector<float>& theirs) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < ours.size(); ++i)
    same += ours[i] == theirs[i] || std::fabs(ours[i] - theirs[i]) <= 1e-3f * theirs[i];
  return static_cast<double>(same) / static_cast<double>(ours.size());
}

double agreement(const std::vector<bool>& ours, const std::vector<bool>& theirs) {
  std::size_t same = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) same += ours[i] == theirs[i];
  return static_cast<double>(same) / static_cast<double>(ours.size());
}

} // namespace wavepath
