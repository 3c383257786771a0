#include "host/convert/shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace wavepath::convert {
namespace {

constexpr double kTurn = 6.283185307179586;
constexpr std::uint32_t kAround = 96, kAlong = 48; // of a whole circle, of a half: a sphere lacks 0.1 % of its area

// A surface over a grid of (u, v); v grows along the second direction. `point` gives position and normal.
template <class Point>
Mesh over_grid(std::uint32_t across, std::uint32_t along, const Point& point) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= along; ++j)
    for (std::uint32_t i = 0; i <= across; ++i) {
      const double u = static_cast<double>(i) / across, v = static_cast<double>(j) / along;
      const auto [position, normal] = point(u, v);
      mesh.positions.emplace_back(position);
      mesh.normals.emplace_back(normal);
      mesh.uvs.emplace_back(u, v);
    }
  for (std::uint32_t j = 0; j < along; ++j)
    for (std::uint32_t i = 0; i < across; ++i) {
      const std::uint32_t a = j * (across + 1) + i, b = a + 1, c = a + across + 1, d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, b, d, a, d, c});
    }
  remove_bad_triangles(mesh);
  wind_by_normals(mesh);
  return mesh;
}

std::uint32_t steps_around(double phi_max) {
  return std::max(3u, static_cast<std::uint32_t>(std::lround(kAround * phi_max / kTurn)));
}

glm::dvec3 face_normal(const Mesh& mesh, std::size_t triangle) {
  const auto at = [&](std::size_t i) { return glm::dvec3(mesh.positions[mesh.indices[triangle * 3 + i]]); };
  return glm::cross(at(1) - at(0), at(2) - at(0));
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;
Edge edge_of(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

struct LoopEdge {
  std::uint32_t opposite[2] = {0, 0};
  int faces = 0;
  std::uint32_t vertex = 0; // the new one
};

Mesh loop_step(const Mesh& mesh) {
  std::map<Edge, LoopEdge> edges;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3)
    for (std::size_t k = 0; k < 3; ++k) {
      LoopEdge& edge = edges[edge_of(mesh.indices[t + k], mesh.indices[t + (k + 1) % 3])];
      if (edge.faces < 2) edge.opposite[edge.faces] = mesh.indices[t + (k + 2) % 3];
      ++edge.faces;
    }
  const std::size_t count = mesh.positions.size();
  std::vector<glm::dvec3> ring(count, glm::dvec3(0.0)), border(count, glm::dvec3(0.0));
  std::vector<int> valence(count, 0), border_count(count, 0);
  for (const auto& [ends, edge] : edges)
    for (const auto& [a, b] : {ends, Edge{ends.second, ends.first}}) {
      ring[a] += glm::dvec3(mesh.positions[b]);
      ++valence[a];
      if (edge.faces == 2) continue;
      border[a] += glm::dvec3(mesh.positions[b]);
      ++border_count[a];
    }
  Mesh finer;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::dvec3 old(mesh.positions[i]);
    glm::dvec3 moved = old;
    if (border_count[i] == 2) {
      moved = 0.75 * old + 0.125 * border[i];
    } else if (border_count[i] == 0 && valence[i] > 0) {
      const double n = valence[i], c = 0.375 + 0.25 * std::cos(kTurn / n), beta = (0.625 - c * c) / n;
      moved = (1.0 - n * beta) * old + beta * ring[i];
    }
    finer.positions.emplace_back(moved);
  }
  for (auto& [ends, edge] : edges) {
    const glm::dvec3 a(mesh.positions[ends.first]), b(mesh.positions[ends.second]);
    glm::dvec3 middle = 0.5 * (a + b);
    if (edge.faces == 2)
      middle = 0.375 * (a + b) +
               0.125 * (glm::dvec3(mesh.positions[edge.opposite[0]]) + glm::dvec3(mesh.positions[edge.opposite[1]]));
    edge.vertex = static_cast<std::uint32_t>(finer.positions.size());
    finer.positions.emplace_back(middle);
  }
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const std::uint32_t a = mesh.indices[t], b = mesh.indices[t + 1], c = mesh.indices[t + 2];
    const std::uint32_t ab = edges[edge_of(a, b)].vertex, bc = edges[edge_of(b, c)].vertex,
                        ca = edges[edge_of(c, a)].vertex;
    finer.indices.insert(finer.indices.end(), {a, ab, ca, ab, b, bc, ca, bc, c, ab, bc, ca});
  }
  return finer;
}

} // namespace

Mesh sphere(double z_min, double z_max, double phi_max) {
  const double top = std::acos(std::clamp(z_max, -1.0, 1.0)), bottom = std::acos(std::clamp(z_min, -1.0, 1.0));
  const auto along = std::max(2u, static_cast<std::uint32_t>(std::lround(kAlong * (bottom - top) / (0.5 * kTurn))));
  return over_grid(steps_around(phi_max), along, [&](double u, double v) {
    const double theta = top + v * (bottom - top), phi = u * phi_max;
    const double ring = std::sin(theta) < 1e-12 ? 0.0 : std::sin(theta); // poles are points
    const glm::dvec3 n(ring * std::cos(phi), ring * std::sin(phi), std::cos(theta));
    return std::pair{n, n};
  });
}

Mesh cylinder(double phi_max) {
  return over_grid(steps_around(phi_max), 1, [&](double u, double v) {
    const glm::dvec3 n(std::cos(u * phi_max), std::sin(u * phi_max), 0.0);
    return std::pair{n + glm::dvec3(0.0, 0.0, 1.0 - v), n};
  });
}

Mesh disk(double inner, double phi_max) {
  return over_grid(steps_around(phi_max), 1, [&](double u, double v) {
    const double r = inner + (1.0 - inner) * v, phi = u * phi_max;
    return std::pair{glm::dvec3(r * std::cos(phi), r * std::sin(phi), 0.0), glm::dvec3(0.0, 0.0, 1.0)};
  });
}

Mesh rectangle() {
  return over_grid(1, 1, [](double u, double v) {
    return std::pair{glm::dvec3(2.0 * u - 1.0, 2.0 * v - 1.0, 0.0), glm::dvec3(0.0, 0.0, 1.0)};
  });
}

Mesh cube() {
  Mesh mesh;
  for (int axis = 0; axis < 3; ++axis)
    for (const double side : {-1.0, 1.0}) {
      glm::dvec3 n(0.0), a(0.0), b(0.0);
      n[axis] = side, a[(axis + 1) % 3] = 1.0, b[(axis + 2) % 3] = side;
      const Mesh face = over_grid(1, 1, [&](double u, double v) {
        return std::pair{n + (2.0 * u - 1.0) * a + (2.0 * v - 1.0) * b, n};
      });
      const auto first = static_cast<std::uint32_t>(mesh.positions.size());
      mesh.positions.insert(mesh.positions.end(), face.positions.begin(), face.positions.end());
      mesh.normals.insert(mesh.normals.end(), face.normals.begin(), face.normals.end());
      mesh.uvs.insert(mesh.uvs.end(), face.uvs.begin(), face.uvs.end());
      for (const std::uint32_t index : face.indices) mesh.indices.push_back(first + index);
    }
  return mesh;
}

void reverse(Mesh& mesh) {
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) std::swap(mesh.indices[t + 1], mesh.indices[t + 2]);
  for (glm::vec3& normal : mesh.normals) normal = -normal;
}

void wind_by_normals(Mesh& mesh) {
  if (mesh.normals.empty()) return;
  for (std::size_t t = 0; t * 3 + 2 < mesh.indices.size(); ++t) {
    glm::dvec3 shading(0.0);
    for (std::size_t k = 0; k < 3; ++k) shading += glm::dvec3(mesh.normals[mesh.indices[t * 3 + k]]);
    if (glm::dot(face_normal(mesh, t), shading) < 0.0) std::swap(mesh.indices[t * 3 + 1], mesh.indices[t * 3 + 2]);
  }
}

void add_normals(Mesh& mesh) {
  std::vector<glm::dvec3> sums(mesh.positions.size(), glm::dvec3(0.0));
  for (std::size_t t = 0; t * 3 + 2 < mesh.indices.size(); ++t) {
    const glm::dvec3 cross = face_normal(mesh, t);
    const double length = glm::length(cross);
    if (!(length > 0.0)) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto at = [&](std::size_t i) { return glm::dvec3(mesh.positions[mesh.indices[t * 3 + (k + i) % 3]]); };
      const glm::dvec3 a = at(1) - at(0), b = at(2) - at(0);
      sums[mesh.indices[t * 3 + k]] += cross / length * std::atan2(length, glm::dot(a, b));
    }
  }
  mesh.normals.clear();
  for (const glm::dvec3& sum : sums) {
    const double length = glm::length(sum);
    mesh.normals.emplace_back(length > 0.0 ? sum / length : glm::dvec3(0.0, 0.0, 1.0));
  }
}

std::uint64_t remove_bad_triangles(Mesh& mesh) {
  const auto finite = [](const glm::vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); };
  std::size_t kept = 0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    const glm::vec3 &a = mesh.positions[mesh.indices[t]], &b = mesh.positions[mesh.indices[t + 1]],
                    &c = mesh.positions[mesh.indices[t + 2]];
    if (a == b || b == c || c == a || !finite(a) || !finite(b) || !finite(c)) continue;
    for (std::size_t k = 0; k < 3; ++k) mesh.indices[kept + k] = mesh.indices[t + k];
    kept += 3;
  }
  const std::uint64_t removed = (mesh.indices.size() - kept) / 3;
  mesh.indices.resize(kept);
  return removed;
}

double area(const Mesh& mesh, const glm::dmat4& matrix) {
  double sum = 0.0;
  for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
    glm::dvec3 p[3];
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = glm::dvec3(matrix * glm::dvec4(mesh.positions[mesh.indices[t + k]], 1.0));
    sum += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  }
  return sum;
}

Mesh subdivided(const Mesh& control, int levels) {
  Mesh mesh;
  mesh.positions = control.positions;
  mesh.indices = control.indices;
  for (int level = 0; level < levels; ++level) mesh = loop_step(mesh);
  add_normals(mesh);
  return mesh;
}

} // namespace wavepath::convert
