#include "host/integrators/hybrid/raster/culling.h"
#include "kernels/base/scene_types.h"
#include "kernels/hybrid/filter_types.h"

#include <algorithm>
#include <array>

namespace wavepath {
namespace {

// Small enough to have a tight box, large enough that asking costs nothing beside drawing.
constexpr std::uint32_t kChunkTriangles = 256;
constexpr double kFilterReach = 2.0; // pixels that a frame may be shifted by; the widest filter reaches 1.5
constexpr double kRounding = 1e-6;   // relative, of positions on the device

// Chunk of an object's triangles [first, first + count).
Chunk chunk_of(const PackedScene& scene, std::uint32_t first, std::uint32_t count) {
  glm::dvec3 lo(gpu::kFar), hi(-gpu::kFar);
  for (std::uint32_t t = first; t < first + count; ++t)
    for (const glm::vec3& v : {scene.triangles[t].v0, scene.triangles[t].v1, scene.triangles[t].v2}) {
      lo = glm::min(lo, glm::dvec3(v));
      hi = glm::max(hi, glm::dvec3(v));
    }
  return {{first, count, 0, 1}, 0.5 * (lo + hi), 0.5 * (hi - lo)};
}

// From object to world; the box around the moved box.
Chunk placed(Chunk chunk, const gpu::Instance& instance, std::uint32_t index) {
  const glm::dvec3 centre = chunk.centre, half = chunk.half;
  for (int axis = 0; axis < 3; ++axis) {
    const glm::dvec4 row(instance.world_from_object[axis]);
    chunk.centre[axis] = glm::dot(glm::dvec3(row), centre) + row.w;
    chunk.half[axis] = glm::dot(glm::abs(glm::dvec3(row)), half);
  }
  chunk.draw.first_instance = index;
  return chunk;
}

// The four sides of the picture, and the two clip planes: what is in front of the camera, if there are none.
std::array<HalfSpace, 6> frustum(const gpu::CameraView& camera, std::uint32_t width, std::uint32_t height,
                                 const ShownPart& part) {
  const glm::dvec3 eye(camera.position), forward(camera.forward);
  // Coordinates that reach from -1 to 1 across the picture: of a point in perspective after division by its depth.
  const glm::dvec3 x = glm::dvec3(camera.right) / glm::dot(glm::dvec3(camera.right), glm::dvec3(camera.right));
  const glm::dvec3 y = glm::dvec3(camera.up) / glm::dot(glm::dvec3(camera.up), glm::dvec3(camera.up));
  const double reach_x = 1.0 + 2.0 * kFilterReach / width, reach_y = 1.0 + 2.0 * kFilterReach / height;
  const auto side = [&](const glm::dvec3& inwards, double reach) {
    const glm::dvec3 normal = camera.orthographic ? inwards : inwards + reach * forward;
    return HalfSpace{normal, (camera.orthographic ? reach : 0.0) - glm::dot(normal, eye)};
  };
  const double ahead = glm::dot(forward, eye);
  return {side(-x, reach_x + part.shift.x),
          side(x, reach_x - part.shift.x),
          side(-y, reach_y + part.shift.y),
          side(y, reach_y - part.shift.y),
          HalfSpace{forward, -ahead - part.clip.near},
          HalfSpace{-forward, ahead + std::min(part.clip.far, double{gpu::kFar})}};
}

bool may_see(std::span<const HalfSpace> frustum, const Chunk& chunk) {
  const glm::dvec3 half = chunk.half + kRounding * (glm::abs(chunk.centre) + chunk.half);
  return std::ranges::none_of(frustum, [&](const HalfSpace& inside) {
    return glm::dot(inside.normal, chunk.centre) + glm::dot(glm::abs(inside.normal), half) + inside.offset < 0.0;
  });
}

// True if `next` continues `draw` in triangles or in instances.
bool join(Draw& draw, const Draw& next) {
  const bool same_instances = draw.first_instance == next.first_instance && draw.instance_count == next.instance_count;
  if (same_instances && draw.first_triangle + draw.triangle_count == next.first_triangle) {
    draw.triangle_count += next.triangle_count;
    return true;
  }
  const bool same_triangles = draw.first_triangle == next.first_triangle && draw.triangle_count == next.triangle_count;
  if (!same_triangles || draw.first_instance + draw.instance_count != next.first_instance) return false;
  draw.instance_count += next.instance_count;
  return true;
}

} // namespace

std::vector<Chunk> make_chunks(const PackedScene& scene) {
  std::vector<Chunk> chunks;
  for (const Draw& draw : scene.draws) {
    // Objects with several instances are tested as a whole.
    const std::uint32_t step = draw.instance_count > 1 ? draw.triangle_count : kChunkTriangles;
    for (std::uint32_t done = 0; done < draw.triangle_count; done += step) {
      const Chunk chunk = chunk_of(scene, draw.first_triangle + done, std::min(step, draw.triangle_count - done));
      if (!scene.root_is_top) chunks.push_back(chunk);
      for (std::uint32_t i = 0; scene.root_is_top && i < draw.instance_count; ++i)
        chunks.push_back(placed(chunk, scene.instances[draw.first_instance + i], draw.first_instance + i));
    }
  }
  return chunks;
}

std::vector<Draw> draws_within(std::span<const Chunk> chunks, std::span<const HalfSpace> sides) {
  std::vector<Draw> draws;
  for (const Chunk& chunk : chunks)
    if (may_see(sides, chunk) && (draws.empty() || !join(draws.back(), chunk.draw))) draws.push_back(chunk.draw);
  return draws;
}

std::vector<Draw> visible_draws(std::span<const Chunk> chunks, const gpu::CameraView& camera, std::uint32_t width,
                                std::uint32_t height, const ShownPart& part) {
  return draws_within(chunks, frustum(camera, width, height, part));
}

} // namespace wavepath
