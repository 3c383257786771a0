// Looks around inside a scene with rays on the CPU; see interior.h.
#include "host/scene/staging/interior.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>

#include "bvh/build.h"
#include "bvh/traverse.h"
#include "host/scene/usage.h"

namespace wavepath {
namespace {

using std::numbers::pi;
constexpr std::uint64_t kMostTriangles = std::uint64_t{1} << 24; // more are not looked through,
constexpr std::uint64_t kMostAsTheyAre = std::uint64_t{1} << 14; // and more are simplified

// The probes: points in the box, each with directions all round.
constexpr int kProbesAcross = 6, kProbesUp = 3, kDirections = 64;
// Measured on 66 files: of rooms 0.60 of the probes and more are enclosed, of boxes without a front 0.44 and less, of
// other objects 0.1 and less.
constexpr double kEnclosed = 0.9;          // fraction of a probe's rays that meet a front face
constexpr double kCovered = 0.7;           // the same for a standpoint, which may be under an open roof or at a window
constexpr double kBackFacing = 0.1;        // largest fraction of its rays that meet a back face
constexpr double kRoomFraction = 0.5;      // fraction of all probes that are enclosed
constexpr double kRoughRoomFraction = 0.1; // with thin walls merged

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

// Calls `visit` with the corners of each opaque triangle, counter-clockwise seen from where it faces.
template <class Visit>
void visit_triangles(const Scene& scene, Visit&& visit) {
  for (const Instance& instance : scene.instances) {
    const Mesh& mesh = scene.meshes[instance.mesh];
    const glm::dmat4& transform = instance.world_from_object;
    const bool mirrored = glm::determinant(glm::dmat3(transform)) < 0.0;
    for (const Primitive& primitive : mesh.primitives) {
      if (is_opening(scene.materials[primitive.material])) continue;
      for (std::uint32_t i = 0; i + 2 < primitive.index_count; i += 3) {
        const std::uint32_t* index = mesh.indices.data() + primitive.first_index + i;
        glm::dvec3 p[3];
        for (int k = 0; k < 3; ++k) p[k] = transform_point(transform, mesh.positions[index[k]]);
        if (!finite_point(p[0]) || !finite_point(p[1]) || !finite_point(p[2])) continue;
        if (mirrored) std::swap(p[1], p[2]);
        visit(p);
      }
    }
  }
}

// Clusters vertices in the cells of a grid over the box: what has three cells remains, once. Surfaces stay closed and
// keep their shape to within half a cell, and a tree over the rest is built in a fraction of the time.
std::vector<bvh::Triangle> simplified(const Scene& scene, const Bounds& bounds, int cell_count) {
  constexpr int kCellBits = 7, kKeyBits = 3 * kCellBits;
  constexpr std::uint64_t kCellMask = (1u << kCellBits) - 1;
  const glm::dvec3 cell = glm::max(bounds.hi - bounds.lo, glm::dvec3(1e-300)) / static_cast<double>(cell_count);
  std::vector<std::uint64_t> keys;
  visit_triangles(scene, [&](const glm::dvec3(&p)[3]) {
    std::uint64_t cells[3];
    for (int k = 0; k < 3; ++k) {
      const glm::ivec3 at =
          glm::clamp(glm::ivec3((p[k] - bounds.lo) / cell), glm::ivec3(0), glm::ivec3(cell_count - 1));
      cells[k] = static_cast<std::uint64_t>((at.z << 2 * kCellBits) | (at.y << kCellBits) | at.x);
    }
    if (cells[0] == cells[1] || cells[1] == cells[2] || cells[2] == cells[0]) return;
    std::rotate(cells, std::min_element(cells, cells + 3), cells + 3);
    keys.push_back(cells[0] << 2 * kKeyBits | cells[1] << kKeyBits | cells[2]);
  });
  std::sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());

  std::vector<bvh::Triangle> triangles;
  triangles.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    bvh::Vec3 p[3];
    for (int k = 0; k < 3; ++k) {
      const std::uint64_t at = key >> (2 - k) * kKeyBits;
      const glm::dvec3 middle(at & kCellMask, at >> kCellBits & kCellMask, at >> 2 * kCellBits & kCellMask);
      p[k] = vec3(bounds.lo + (middle + 0.5) * cell - bounds.centre());
    }
    triangles.push_back({p[0], p[1], p[2]});
  }
  return triangles;
}

// `cell_count`: along each side of the box, of the grid to simplify with; 0 = the triangles as they are.
Geometry gather(const Scene& scene, const Bounds& bounds, int cell_count) {
  Geometry geometry{bounds.centre(), {}, {}};
  std::vector<bvh::Triangle> triangles;
  if (cell_count > 0) {
    triangles = simplified(scene, bounds, cell_count);
  } else {
    visit_triangles(scene, [&](const glm::dvec3(&p)[3]) {
      triangles.push_back({vec3(p[0] - geometry.origin), vec3(p[1] - geometry.origin), vec3(p[2] - geometry.origin)});
    });
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
  const double phi = 2.0 * pi * std::fmod(i / std::numbers::phi, 1.0);
  return {r * std::cos(phi), y, r * std::sin(phi)};
}

bool is_enclosed(const Geometry& geometry, const glm::dvec3& point, double least) {
  int front = 0, back = 0;
  for (int i = 0; i < kDirections; ++i) {
    const Sight sight = look(geometry, point, lattice_direction(i, kDirections));
    if (std::isinf(sight.distance)) continue;
    ++(sight.front ? front : back);
  }
  return front >= least * kDirections && back <= kBackFacing * kDirections;
}

// The middle of cell (x, y, z) of a grid over the box.
glm::dvec3 cell_middle(const Bounds& bounds, const glm::ivec3& cell, const glm::ivec3& cells) {
  return bounds.lo + (bounds.hi - bounds.lo) * ((glm::dvec3(cell) + 0.5) / glm::dvec3(cells));
}

// The fraction of the probes that are enclosed.
double enclosed_fraction(const Geometry& geometry, const Bounds& bounds) {
  const glm::ivec3 cells(kProbesAcross, kProbesUp, kProbesAcross);
  int enclosed = 0;
  for (int z = 0; z < cells.z; ++z)
    for (int y = 0; y < cells.y; ++y)
      for (int x = 0; x < cells.x; ++x)
        enclosed += is_enclosed(geometry, cell_middle(bounds, {x, y, z}, cells), kEnclosed);
  return static_cast<double>(enclosed) / (cells.x * cells.y * cells.z);
}

struct Vista {
  double length = 0.0, azimuth = 0.0;
  double worth = 0.0; // its length times the middle distance across the picture
};

// The worthiest free way that begins at `eye`; none where a wall is close on any side. Its length is the second
// shortest of a few rays side by side, so that it is as wide as a person, but one chair leg does not end it. What leads
// out, or to a back that may not be seen, is no way.
Vista longest_vista(const Geometry& geometry, const glm::dvec3& eye, double clearance) {
  constexpr int kAzimuths = 96, kAside = 2, kWide = 10; // rays to either side: of 15 degrees in all, of 75
  double distances[kAzimuths], seen[kAzimuths];
  for (int a = 0; a < kAzimuths; ++a) {
    const double azimuth = 2.0 * pi * a / kAzimuths;
    const Sight sight = look(geometry, eye, {std::sin(azimuth), 0.0, std::cos(azimuth)});
    if (sight.distance < clearance) return {};
    seen[a] = std::isinf(sight.distance) ? clearance : sight.distance;
    distances[a] = std::isinf(sight.distance) || !sight.front ? 0.0 : sight.distance;
  }
  Vista longest;
  for (int a = 0; a < kAzimuths; ++a) {
    double near[2 * kAside + 1], wide = 0.0;
    for (int i = 0; i <= 2 * kAside; ++i) near[i] = distances[(a + i - kAside + kAzimuths) % kAzimuths];
    std::nth_element(near, near + 1, std::end(near));
    for (int i = -kWide; i <= kWide; ++i)
      wide += std::log(std::max(seen[(a + i + kAzimuths) % kAzimuths], clearance)) / (2 * kWide + 1);
    const double worth = near[1] * std::exp(wide);
    if (worth > longest.worth) longest = {near[1], 2.0 * pi * a / kAzimuths, worth};
  }
  return longest;
}

// Height of the eye over the floor of a room of this height: a person's, if the numbers can be metres.
double eye_height(double room_height) {
  constexpr double kEye = 1.6, kLowest = 2.0, kHighest = 40.0;
  return room_height >= kLowest && room_height <= kHighest ? kEye : 0.6 * room_height;
}

// True if no ray from an enclosed probe gets out.
bool is_closed(const Geometry& geometry, const Bounds& bounds) {
  const glm::ivec3 cells(kProbesAcross, kProbesUp, kProbesAcross);
  for (int i = 0; i < cells.x * cells.y * cells.z; ++i) {
    const glm::dvec3 point = cell_middle(bounds, {i % cells.x, i / cells.x % cells.y, i / (cells.x * cells.y)}, cells);
    if (!is_enclosed(geometry, point, kEnclosed)) continue;
    for (int k = 0; k < kDirections; ++k)
      if (std::isinf(look(geometry, point, lattice_direction(k, kDirections)).distance)) return false;
  }
  return true;
}

// A third of the way before the eye, a fifth of the way up to the ceiling below it.
void hang_lamp(const Geometry& geometry, Standpoint& standpoint) {
  const glm::dvec3 below = glm::mix(standpoint.eye, standpoint.target, 1.0 / 3.0);
  const Sight ceiling = look(geometry, below, {0.0, 1.0, 0.0}), floor = look(geometry, below, {0.0, -1.0, 0.0});
  if (std::isinf(ceiling.distance) || std::isinf(floor.distance)) return;
  standpoint.lamp = below + glm::dvec3(0.0, 0.8 * ceiling.distance, 0.0);
  standpoint.lamp_height = 0.8 * ceiling.distance + floor.distance;
}

} // namespace

std::optional<Standpoint> find_standpoint(const Scene& scene, const Bounds& bounds) {
  const Usage usage = find_usage(scene);
  if (usage.triangles_seen == 0 || usage.triangles_seen > kMostTriangles || bounds.empty()) return std::nullopt;
  // Most scenes are objects, which a rough look tells at little cost.
  const bool large = usage.triangles_seen > kMostAsTheyAre;
  if (large && enclosed_fraction(gather(scene, bounds, 32), bounds) < kRoughRoomFraction) return std::nullopt;
  const Geometry geometry = gather(scene, bounds, large ? 128 : 0);
  if (enclosed_fraction(geometry, bounds) < kRoomFraction) return std::nullopt;

  const glm::dvec3 size = bounds.hi - bounds.lo;
  const double clearance = 0.02 * glm::length(glm::dvec2(size.x, size.z)); // from all walls
  double best = 0.0;
  std::optional<Standpoint> found;
  const glm::ivec3 cells(12, 4, 12);
  for (int z = 0; z < cells.z; ++z)
    for (int x = 0; x < cells.x; ++x) {
      std::optional<double> last_floor; // several starts over one floor are one position
      for (int y = 0; y < cells.y; ++y) {
        const glm::dvec3 middle = cell_middle(bounds, {x, y, z}, cells);
        const Sight floor = look(geometry, middle, {0.0, -1.0, 0.0}), ceiling = look(geometry, middle, {0.0, 1.0, 0.0});
        if (std::isinf(floor.distance) || !floor.front) continue;
        const double floor_y = middle.y - floor.distance;
        if (last_floor && std::abs(floor_y - *last_floor) < 1e-3 * size.y) continue;
        last_floor = floor_y;
        const double height = floor.distance + std::min(ceiling.distance, bounds.hi.y - middle.y);
        const glm::dvec3 eye(middle.x, floor_y + eye_height(height), middle.z);
        const Vista vista = longest_vista(geometry, eye, clearance);
        if (vista.worth == 0.0) continue;
        y = cells.y; // the lowest floor to stand on; others are roofs and galleries
        if (vista.worth <= best || !is_enclosed(geometry, eye, kCovered)) continue;
        best = vista.worth;
        found = Standpoint{eye, eye + vista.length * glm::dvec3(std::sin(vista.azimuth), 0.0, std::cos(vista.azimuth))};
      }
    }
  if (found && is_closed(geometry, bounds)) hang_lamp(geometry, *found);
  return found;
}

} // namespace wavepath
