// Small scenes built in code, and the renders that cases make of them.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/gpu/device.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"
#include "host/scene/scene.h"

namespace wavepath {

// A double-sided Lambert material without specular reflection; returns its index.
std::uint32_t add_lambert(Scene& scene, glm::vec3 albedo, glm::vec3 emission = glm::vec3(0.0f));

// A mesh of separate triangles, three positions each, shown once.
void add_triangles(Scene& scene, const std::vector<glm::vec3>& positions, std::uint32_t material,
                   const glm::dmat4& world_from_object = glm::dmat4(1.0));

// Two triangles: corner + [0,1] * a + [0,1] * b, facing cross(a, b).
void add_quad(Scene& scene, glm::vec3 corner, glm::vec3 a, glm::vec3 b, std::uint32_t material);

// A perspective camera at `eye`, looking at `target`; `yfov` in radians.
void look_at(Scene& scene, glm::dvec3 eye, glm::dvec3 target, double yfov, glm::dvec3 up = {0.0, 1.0, 0.0});

// Packs one double-sided mesh of these triangles.
PackedScene pack_positions(const std::vector<glm::vec3>& positions, bvh::Quality quality = bvh::Quality::fast);

// Packs and renders with the scene's first camera.
RenderResult render_scene(Device& device, Scene scene, const RenderPlan& settings);

// Mean over all pixels.
double mean_of(const Picture& picture, int channel);

} // namespace wavepath
