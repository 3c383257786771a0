#include "host/integrators/hybrid/shadows/receiver_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host/integrators/hybrid/raster/placed_triangles.h"

namespace wavepath {
namespace {

constexpr double kTolerance = 1e-5;                      // of the scene's radius
constexpr double kCellAngle = 1e-3;                      // of normals, by which triangles are sorted at first
constexpr double kCellOffset = 1e-3;                     // of the scene's radius
constexpr std::size_t kMostCandidates = 4 * kMostPlanes; // a plane may be spread over cells next to each other

struct PlacedTriangle {
  std::array<glm::dvec3, 3> corners;
  glm::dvec3 normal; // of unit length, one of the two
  double area;
};

PlacedTriangle placed(const gpu::Triangle& triangle, const gpu::Instance* instance) {
  PlacedTriangle out{placed_corners(triangle, instance), {}, 0.0};
  const glm::dvec3 cross = glm::cross(out.corners[1] - out.corners[0], out.corners[2] - out.corners[0]);
  const double length = glm::length(cross);
  out.area = 0.5 * length;
  out.normal = length > 0.0 ? cross / length : glm::dvec3(0.0);
  // One sign for both sides: that of the largest component.
  const glm::dvec3 size = glm::abs(out.normal);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  if (out.normal[axis] < 0.0) out.normal = -out.normal;
  return out;
}

// Every triangle that can be seen, once.
template <typename Visit>
void for_each_placed(const PackedScene& scene, const Visit& visit) {
  for (const Draw& draw : scene.draws)
    for_each_triangle(scene, draw, [&](std::uint32_t t) {
      for (std::uint32_t i = draw.first_instance; i < draw.first_instance + draw.instance_count; ++i) {
        const PlacedTriangle one = placed(scene.triangles[t], instance_of(scene, i));
        if (one.area > 0.0) visit(one);
      }
    });
}

struct Cell {
  double area = 0.0, largest = 0.0;
  ReceiverPlane plane; // of the largest triangle
};

bool lies_in(const PlacedTriangle& triangle, const ReceiverPlane& plane, double tolerance) {
  return std::ranges::all_of(triangle.corners, [&](const glm::dvec3& corner) {
    return std::abs(glm::dot(plane.normal, corner) + plane.offset) <= tolerance;
  });
}

} // namespace

double plane_tolerance(const PackedScene& scene) { return kTolerance * scene.radius; }

// Triangles are sorted into cells by their planes; the largest of a cell says where its plane is, exactly.
std::vector<ReceiverPlane> receiver_planes(const PackedScene& scene) {
  std::map<std::array<std::int64_t, 4>, Cell> cells;
  double whole = 0.0;
  for_each_placed(scene, [&](const PlacedTriangle& triangle) {
    const double offset = -glm::dot(triangle.normal, triangle.corners[0]);
    const auto cell_of = [](double x, double size) { return static_cast<std::int64_t>(std::floor(x / size + 0.5)); };
    Cell& cell = cells[{cell_of(triangle.normal.x, kCellAngle), cell_of(triangle.normal.y, kCellAngle),
                        cell_of(triangle.normal.z, kCellAngle), cell_of(offset, kCellOffset * scene.radius)}];
    whole += triangle.area;
    cell.area += triangle.area;
    if (triangle.area <= cell.largest) return;
    cell.largest = triangle.area;
    cell.plane = {triangle.normal, offset, 0.0};
  });
  std::vector<Cell> candidates;
  for (const auto& [key, cell] : cells) candidates.push_back(cell);
  std::ranges::stable_sort(candidates, std::ranges::greater(), &Cell::area);
  candidates.resize(std::min(candidates.size(), kMostCandidates));
  std::vector<ReceiverPlane> planes;
  for (const Cell& cell : candidates) planes.push_back(cell.plane);
  const double tolerance = plane_tolerance(scene);
  for_each_placed(scene, [&](const PlacedTriangle& triangle) {
    // Counts a triangle for the first plane that it lies in only, so that planes found twice get no area.
    const auto found =
        std::ranges::find_if(planes, [&](const ReceiverPlane& plane) { return lies_in(triangle, plane, tolerance); });
    if (found != planes.end()) found->area += triangle.area;
  });
  std::ranges::stable_sort(planes, std::ranges::greater(), &ReceiverPlane::area);
  std::erase_if(planes, [&](const ReceiverPlane& plane) { return plane.area < kLeastFraction * whole; });
  planes.resize(std::min(planes.size(), kMostPlanes));
  return planes;
}

std::string no_receiver_planes(const PackedScene& scene) {
  if (!receiver_planes(scene).empty()) return "";
  return fmt::format("casts shadows on large planes alone, and this scene has none with {} % of its surfaces",
                     100.0 * kLeastFraction);
}

} // namespace wavepath
