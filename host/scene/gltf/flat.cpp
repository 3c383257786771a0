// The cofactors of a matrix of rank two are k u v^T: u stands on the plane that it leaves, v is what it takes away.
#include "host/scene/gltf/flat.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace wavepath::gltf {
namespace {

double largest_entry(const glm::dmat3& m) {
  double largest = 0.0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) largest = std::max(largest, std::abs(m[i][j]));
  return largest;
}

glm::dmat3 cofactors(const glm::dmat3& m) {
  return {glm::cross(m[1], m[2]), glm::cross(m[2], m[0]), glm::cross(m[0], m[1])};
}

const glm::dvec3& longest(const glm::dmat3& m) {
  int best = 0;
  for (int i = 1; i < 3; ++i)
    if (glm::length(m[i]) > glm::length(m[best])) best = i;
  return m[best];
}

// Instances that are flattened along the same direction share a mesh, so that rounding must not tell them apart.
glm::dvec3 rounded(const glm::dvec3& unit) {
  const glm::dvec3 steps = glm::round(unit * 0x1p40);
  const glm::dvec3 sized = glm::abs(steps);
  const int largest = sized.x >= sized.y && sized.x >= sized.z ? 0 : sized.y >= sized.z ? 1 : 2;
  return glm::normalize(steps[largest] < 0.0 ? -steps : steps) + 0.0; // no zero is negative
}

} // namespace

Extent extent_of(const glm::dmat3& linear) {
  const double size = largest_entry(linear);
  if (!(size > 0.0)) return Extent::none;
  const glm::dmat3 m = linear / size, c = cofactors(m);
  const double length = glm::length(longest(m)), area = glm::length(longest(c));
  if (area <= kFlatRounding * length * length) return Extent::none;
  return std::abs(glm::dot(m[0], c[0])) <= kFlatRounding * length * area ? Extent::flat : Extent::solid;
}

FlatTransform flat_transform(const glm::dmat4& world_from_object, bool mirrors) {
  const glm::dmat3 linear(world_from_object);
  const double size = largest_entry(linear);
  const glm::dmat3 m = linear / size, c = cofactors(m);
  const glm::dvec3 up = glm::normalize(longest(c));
  FlatTransform transform{rounded(glm::normalize(longest(glm::transpose(c)))), world_from_object};
  // With s along u v^T the determinant is s k. The size of this s is the shorter side of the flat thing.
  const double k = glm::dot(up, c * transform.direction);
  const double s = (mirrors ? -size : size) * k / glm::length(longest(m));
  for (int i = 0; i < 3; ++i) transform.world_from_flat[i] += glm::dvec4(s * transform.direction[i] * up, 0.0);
  return transform;
}

Mesh flattened(const Mesh& mesh, const glm::dvec3& direction) {
  Mesh flat = mesh;
  flat.content = 0;
  const auto flatten = [&](const glm::vec3& v) {
    return glm::vec3(glm::dvec3(v) - direction * glm::dot(direction, glm::dvec3(v)));
  };
  for (glm::vec3& p : flat.positions) p = flatten(p);
  for (std::vector<glm::vec4>* tangents : {&flat.tangents, &flat.layer_tangents[0], &flat.layer_tangents[1]})
    for (glm::vec4& t : *tangents) {
      const glm::dvec3 along(flatten(glm::vec3(t)));
      t = glm::vec4(glm::vec3(along / std::max(glm::length(along), 1e-300)), t.w);
    }
  flat.normals.clear();
  for (Primitive& primitive : flat.primitives) primitive.has_normals = false;
  return flat;
}

Mesh collapsed(const Mesh& mesh, const glm::dmat4& world_from_object) {
  Mesh line = mesh;
  line.content = 0;
  for (glm::vec3& p : line.positions) p = glm::vec3(world_from_object * glm::dvec4(p, 1.0));
  return line;
}

} // namespace wavepath::gltf
