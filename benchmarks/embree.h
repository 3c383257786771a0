// The same triangles and the same rays in Embree, as a yardstick. Built only where Embree's headers are found.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/scene/pack/pack.h"
#include "kernels/base/frame_types.h"
#include "kernels/path/path_types.h"

namespace wavepath {

// A medium-quality Embree scene of all placed triangles. `robust`: its watertight mode, the fair twin of ours.
class EmbreeScene {
public:
  EmbreeScene(const PackedScene& scene, bool robust);
  ~EmbreeScene();
  EmbreeScene(EmbreeScene&&) = delete;

  double build_seconds() const { return build_seconds_; }

  // Seconds that rtcIntersect1 (rtcOccluded1) takes for all rays on all cores. `t`: of the closest hits, infinite for a
  // miss.
  double intersect(std::span<const gpu::Ray> rays, std::vector<float>* t = nullptr) const;
  double occluded(std::span<const gpu::ShadowRay> rays, std::vector<bool>* blocked = nullptr) const;

private:
  struct Handles;
  std::unique_ptr<Handles> handles_;
  double build_seconds_ = 0.0;
};

} // namespace wavepath
