#include "host/integrators/radiosity/adaptive_patches.h"

#include <algorithm>
#include <array>
#include <queue>

namespace wavepath {
namespace {

// Smaller patches than this, relative to the mean one of the mesh to be made, would catch too few rays.
constexpr double kLeastArea = 1.0 / 32.0;

struct Candidate {
  double error;
  std::uint32_t patch;
  double area;
  bool operator<(const Candidate& other) const {
    return error != other.error ? error < other.error : patch > other.patch;
  }
};

double brightness(const glm::dvec3& light) { return light.r + light.g + light.b; }

// Radiosity between the corners of a face differs by so much.
double range_of(const Face& face, std::span<const glm::vec4> corners) {
  double lowest = 1e300, highest = 0.0;
  for (const glm::vec4& corner : corners) {
    const double value = brightness(face.reflectance * glm::dvec3(corner));
    lowest = std::min(lowest, value), highest = std::max(highest, value);
  }
  return highest - lowest;
}

} // namespace

void refine(PatchTree& tree, const PatchMesh& mesh, const std::vector<Face>& faces, std::span<const glm::vec4> corners,
            std::uint32_t count) {
  double area = 0.0;
  std::priority_queue<Candidate> queue;
  for (std::uint32_t patch = 0; patch < tree.size(); ++patch) {
    double range = 0.0;
    for (std::size_t face = 2 * std::size_t{patch}; face < 2 * std::size_t{patch} + 2; ++face)
      range = std::max(range, range_of(faces[face], corners.subspan(3 * face, 3)));
    area += mesh.areas[patch];
    queue.push({range * mesh.areas[patch], patch, mesh.areas[patch]});
  }
  const double least = kLeastArea * area / count;
  while (!queue.empty() && tree.size() + 3 <= count) {
    const Candidate worst = queue.top();
    queue.pop();
    const std::uint32_t next = tree.size();
    if (worst.area < 4.0 * least || !split(tree, worst.patch)) continue;
    // Of a linear change each part has half, on a quarter of the area.
    for (const std::uint32_t part : {worst.patch, next, next + 1, next + 2})
      queue.push({worst.error / 8.0, part, worst.area / 4.0});
  }
}

} // namespace wavepath
