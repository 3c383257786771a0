// Options of packing, which plan() and pack() both use.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <glm/glm.hpp>

#include "bvh/build.h"
#include "host/scene/pack/atlas.h"
#include "kernels/base/features.h"

namespace wavepath {

struct Packing {
  std::uint32_t direct = gpu::kDirectMis; // kDirect*; with kDirectBsdf no light is packed for sampling
  bvh::Quality quality = bvh::Quality::fast;
  // The point around which single precision should be finest: the origin is the point of the geometry's box nearest to
  // it, or the box's centre.
  std::optional<glm::dvec3> eye{};
  // Positions of cameras: triangles that are huge compared with their distance to one are cut, see cut.h.
  std::vector<glm::dvec3> near{};
  std::uint32_t lights = gpu::kLightsAuto; // kLights*: how they are selected, see lights.h
  bool mips = false;    // textures get mip levels, for renders that look them up (host/render/settings/mips.h)
  bool sources = false; // PackedScene::sources are listed, for passes that follow surfaces to another pose
  std::vector<std::string> light_groups{}; // value of --light-groups; empty = lights have no groups
  // The device's samplers look up textures, within these limits.
  std::optional<SamplerLimits> samplers{};
};

} // namespace wavepath
