// Patches of the radiosity mesh: the triangles of a scene, each cut by a tree of its own.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/glm.hpp>

#include "kernels/radiosity/radiosity_types.h"

namespace wavepath {

struct PackedScene;

struct PatchTree {
  std::vector<std::uint32_t> roots; // as kBindPatchRoots has them
  std::vector<std::uint32_t> nodes; // as kBindPatchNodes has them
  std::vector<gpu::Patch> patches;
  std::vector<std::uint32_t> leaves; // by patch: its node
  std::vector<std::uint8_t> levels;  // by patch: how often its triangle was cut

  std::uint32_t size() const { return static_cast<std::uint32_t>(patches.size()); }
};

// Most triangles, those of all instances counted, that a mesh is made of.
inline constexpr std::uint64_t kMostPatchTriangles = 1u << 20;

// Every triangle in 4^n patches, of which none is larger than an area that all share: the least area with which there
// are at most `count` patches. More where the scene has more triangles.
PatchTree uniform_patches(const PackedScene& scene, std::uint32_t count);

// Cuts a patch in four. The first of them keeps its index, the others follow the last patch. A patch that has been cut
// gpu::kDeepestPatch times stays whole; returns whether it was cut.
bool split(PatchTree& tree, std::uint32_t patch);

// Corners in the device's world space, in double precision: what two triangles share comes out the same from both.
std::array<glm::dvec3, 3> corners_of(const PackedScene& scene, const gpu::Patch& patch);

// The bytes of device memory of a mesh of so many patches, of which the scene has `triangles`, placed ones counted.
// `links`: nodes of trees are there as well.
std::uint64_t patch_bytes(std::uint64_t patches, std::uint64_t triangles, bool links);

} // namespace wavepath
