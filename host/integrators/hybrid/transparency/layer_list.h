// The triangles of a scene that are layers, placed, in an order in which they can be drawn.
#pragma once

#include <vector>

#include <glm/glm.hpp>

#include "host/scene/pack/packed_scene.h"
#include "kernels/hybrid/filter_types.h"

namespace wavepath {

struct LayerTriangle {
  glm::uvec2 placed{0};   // index in PackedScene::triangles, and in PackedScene::instances
  glm::dvec3 middle{0.0}; // device world
};

// Triangles of the materials for which `holds` returns true, each once, without copies made by spatial splits, sorted
// by instance and source.
std::vector<LayerTriangle> layer_triangles(const PackedScene& scene, bool (*holds)(const gpu::Material& material));

// From the farthest middle along the view axis to the nearest; of equal ones the first in the list is drawn first.
void sort_back_to_front(std::vector<LayerTriangle>& list, const gpu::CameraView& camera);

} // namespace wavepath
