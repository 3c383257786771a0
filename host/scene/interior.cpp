// Looks around inside a scene with rays on the CPU; see interior.h.
#include "host/scene/interior.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bvh/build.h"
#include "bvh/traverse.h"
#include "host/scene/usage.h"

namespace wavepath {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint64_t kMostTriangles = std::uint64_t{1} << 23; // more are not looked through

// The probes: points in the box, each with directions all round.
constexpr int kProbesAcross = 6, kProbesUp = 3, kDirections = 64;
constexpr double kEnclosed = 0.8;   // of a probe's rays that meet a surface which faces it
constexpr double kBackFacing = 0.1; // and at most so many that meet a back
constexpr double kRoomShare = 0.4;  // of all probes that are enclosed

// Opaque triangles in single precision around `origin`, and the tree over them.
struct Geometry {
  glm::dvec3 origin;
  std::vector<bvh::Triangle> triangles;
  bvh::WideTree tree;
};

bvh::Vec3 vec3(const glm::dvec3& v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

bool is_opening(const Material& material) {
  return material.transmission > 0.0f || material.alpha_mode == AlphaMode::blend;
}

Geometry gather(const Scene& scene, const glm::dvec3& origin, std::uint64_t triangle_count) {
  Geometry geometry{origin, {}, {}};
  std::vector<bvh::Triangle> triangles;
  triangles.reserve(triangle_count);
  const glm::dmat4 centred = glm::translate(glm::dmat4(1.0), -origin);
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const glm::dmat4 transform = centred * instance.world_from_object;
    const bool mirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
    for (const Primitive& primitive : mesh.primitives) {
      if (is_opening(scene.materials[primitive.material])) continue;
      for (std::uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
        const std::uint32_t* index = mesh.indices.data() + primitive.first_index + i;
        bvh::Vec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = vec3(transform_point(transform, mesh.positions[index[k]]));
        if (mirrored) std::swap(p[1], p[2]);
        triangles.push_back({p[0], p[1], p[2]});
      }
    }
  }
  geometry.tree = bvh::build(std::span<const bvh::Triangle>(triangles));
  geometry.triangles.reserve(geometry.tree.order.size());
  for (const std::uint32_t primitive : geometry.tree.order) geometry.triangles.push_back(triangles[primitive]);
  return geometry;
}

struct Sight {
  double distance = std::numeric_limits<double>::infinity(); // to the first surface
  bool front = false;                                        // which faces the eye
};

// `direction` of unit length.
Sight look(const Geometry& geometry, const glm::dvec3& eye, const glm::dvec3& direction) {
  const bvh::Ray ray{vec3(eye - geometry.origin), vec3(direction)};
  const bvh::Hit hit = bvh::closest_hit(geometry.tree, geometry.triangles, ray);
  if (hit.item == bvh::kAbsent) return {};
  const bvh::Triangle& t = geometry.triangles[hit.item];
  const auto to_glm = [](const bvh::Vec3& v) { return glm::dvec3(v.x, v.y, v.z); };
  const glm::dvec3 normal = glm::cross(to_glm(t.v1) - to_glm(t.v0), to_glm(t.v2) - to_glm(t.v0));
  return {hit.triangle.t, glm::dot(normal, direction) < 0.0};
}

// Evenly over the sphere (a Fibonacci lattice).
glm::dvec3 lattice_direction(int i, int count) {
  const double y = 1.0 - (2.0 * i + 1.0) / count, r = std::sqrt(1.0 - y * y);
  const double phi = 2.0 * kPi * std::fmod(i / std::numbers::phi, 1.0);
  return {r * std::cos(phi), y, r * std::sin(phi)};
}

bool is_enclosed(const Geometry& geometry, const glm::dvec3& place) {
  int front = 0, back = 0;
  for (int i = 0; i < kDirections; ++i) {
    const Sight sight = look(geometry, place, lattice_direction(i, kDirections));
    if (std::isinf(sight.distance)) continue;
    ++(sight.front ? front : back);
  }
  return front >= kEnclosed * kDirections && back <= kBackFacing * kDirections;
}

// The middle of cell (x, y, z) of a grid over the box.
glm::dvec3 cell_middle(const Bounds& bounds, const glm::ivec3& cell, const glm::ivec3& cells) {
  return bounds.lo + (bounds.hi - bounds.lo) * ((glm::dvec3(cell) + 0.5) / glm::dvec3(cells));
}

bool is_interior(const Geometry& geometry, const Bounds& bounds) {
  const glm::ivec3 cells(kProbesAcross, kProbesUp, kProbesAcross);
  int enclosed = 0;
  for (int z = 0; z < cells.z; ++z)
    for (int y = 0; y < cells.y; ++y)
      for (int x = 0; x < cells.x; ++x) enclosed += is_enclosed(geometry, cell_middle(bounds, {x, y, z}, cells));
  return enclosed >= kRoomShare * cells.x * cells.y * cells.z;
}

// The free way from `eye` within some degrees of `azimuth`: the second shortest of a few rays, so that it is as wide as
// a person, but one chair leg does not end it. Only up to surfaces that face the eye: what leads out is no way.
double free_way(const Geometry& geometry, const glm::dvec3& eye, double azimuth, double longest) {
  constexpr double kAside[5] = {-8.0, -4.0, 0.0, 4.0, 8.0};
  double ways[5];
  for (int i = 0; i < 5; ++i) {
    const double a = azimuth + glm::radians(kAside[i]);
    const Sight sight = look(geometry, eye, {std::sin(a), 0.0, std::cos(a)});
    ways[i] = std::isinf(sight.distance) ? 0.5 * longest : sight.front ? sight.distance : 0.0;
  }
  std::sort(ways, ways + 5);
  return ways[1];
}

// How high an eye is over the floor of a room of this height: of a person, where the numbers can be metres.
double eye_height(double room_height) {
  constexpr double kEye = 1.6, kLowest = 2.0, kHighest = 40.0;
  return room_height >= kLowest && room_height <= kHighest ? kEye : 0.6 * room_height;
}

} // namespace

std::optional<Standpoint> find_standpoint(const Scene& scene, const Bounds& bounds) {
  const Usage usage = find_usage(scene);
  if (usage.triangles_seen == 0 || usage.triangles_seen > kMostTriangles || bounds.empty()) return std::nullopt;
  const Geometry geometry = gather(scene, bounds.centre(), usage.triangles_seen);
  if (geometry.triangles.empty() || !is_interior(geometry, bounds)) return std::nullopt;

  constexpr int kPlaces = 12, kAzimuths = 48;
  const glm::dvec3 size = bounds.hi - bounds.lo;
  const double longest = glm::length(glm::dvec2(size.x, size.z));
  const double clearance = 0.02 * longest; // all round
  double best = 0.0;
  std::optional<Standpoint> found;
  for (int z = 0; z < kPlaces; ++z)
    for (int x = 0; x < kPlaces; ++x) {
      const glm::dvec3 middle = cell_middle(bounds, {x, 0, z}, {kPlaces, 1, kPlaces});
      const Sight floor = look(geometry, middle, {0.0, -1.0, 0.0}), ceiling = look(geometry, middle, {0.0, 1.0, 0.0});
      if (std::isinf(floor.distance) || !floor.front) continue;
      const double height = floor.distance + std::min(ceiling.distance, bounds.hi.y - middle.y);
      glm::dvec3 eye = middle;
      eye.y += eye_height(height) - floor.distance;
      if (!is_enclosed(geometry, eye)) continue;
      double ways[kAzimuths], nearest = longest;
      for (int a = 0; a < kAzimuths; ++a) {
        ways[a] = free_way(geometry, eye, 2.0 * kPi * a / kAzimuths, longest);
        nearest = std::min(nearest, ways[a]);
      }
      if (nearest < clearance) continue;
      for (int a = 0; a < kAzimuths; ++a) {
        if (ways[a] <= best) continue;
        best = ways[a];
        const double azimuth = 2.0 * kPi * a / kAzimuths;
        found = Standpoint{eye, eye + ways[a] * glm::dvec3(std::sin(azimuth), 0.0, std::cos(azimuth))};
      }
    }
  return found;
}

} // namespace wavepath
