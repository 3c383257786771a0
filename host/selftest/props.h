// Materials, bodies and cameras that cases build their scenes of.
#pragma once

#include <vector>

#include "host/scene/scene.h"

namespace wavepath {

// Add a material and return its index.
std::uint32_t add_material(Scene& scene, const Material& material);
std::uint32_t add_emitter(Scene& scene, float radiance);                  // black, shines to its front alone
std::uint32_t add_metal(Scene& scene, float roughness);                   // reflects all light that meets a facet
std::uint32_t add_glass(Scene& scene, float ior, float roughness = 0.0f); // a clear body

using Triangles = std::vector<glm::vec3>; // three positions each, counter-clockwise seen from the front

Triangles quad(glm::vec3 corner, glm::vec3 a, glm::vec3 b);  // faces cross(a, b)
Triangles box(glm::vec3 lo, glm::vec3 hi);                   // faces out
Triangles disc(glm::vec3 centre, float radius, int sides);   // a regular polygon that faces down
Triangles ball(glm::dvec3 centre, double radius, int rings); // vertices on the sphere, faces out
Triangles flipped(Triangles triangles);

// A wide floor at y = 0 that faces up.
Triangles floor_quad(float half = 1e3f);

// An orthographic camera of half height `extent`, at `distance` from `target` seen along a direction with this cosine
// to +Y.
void look_down(Scene& scene, double extent, double distance, double cosine = 1.0, glm::dvec3 target = glm::dvec3(0.0));

} // namespace wavepath
