// A small scene that has what pilots and training are for: many lamps, and an animation.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/gltf_builder.h"

namespace wavepath::test {

// A floor, lit by as many lamps as have a tree, above it a box that moves along x within a second.
inline std::string moving_box_under_lamps(const TempFolder& folder, int lamps) {
  GltfBuilder b;
  const std::vector<float> square = {-1, 0, 1, 1, 0, 1, 1, 0, -1, -1, 0, -1};
  const int positions = b.floats("VEC3", square);
  const int indices = b.accessor("SCALAR", kUshort, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  const int floor = b.mesh_node({{"POSITION", positions}}, {{"indices", indices}});
  const int lid = b.mesh_node({{"POSITION", positions}}, {{"indices", indices}});
  b.root["nodes"][static_cast<unsigned>(floor)]["scale"] = {4, 1, 4};
  b.root["nodes"][static_cast<unsigned>(lid)]["translation"] = {0, 0.5, 0};
  std::vector<int> shown = {floor, lid};
  nlohmann::json& lights = b.root["extensions"]["KHR_lights_punctual"]["lights"];
  for (int i = 0; i < lamps; ++i) {
    lights.push_back({{"type", "point"}, {"intensity", 1.0 + i % 3}, {"color", {1.0, 0.5 + 0.1 * (i % 5), 0.7}}});
    shown.push_back(b.add("nodes", {{"translation", {-3.0 + 0.7 * (i % 9), 1.5, -3.0 + 0.9 * (i / 9)}},
                                    {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}}));
  }
  b.root["extensionsUsed"] = {"KHR_lights_punctual"};
  const int times = b.floats("SCALAR", {0.0f, 1.0f});
  const int places = b.floats("VEC3", {0.0f, 0.5f, 0.0f, 1.0f, 0.5f, 0.0f});
  b.add("animations", {{"name", "slide"},
                       {"samplers", {{{"input", times}, {"output", places}}}},
                       {"channels", {{{"sampler", 0}, {"target", {{"node", lid}, {"path", "translation"}}}}}}});
  b.root["scenes"] = {{{"nodes", shown}}};
  b.root["scene"] = 0;
  return folder.write("lamps.glb", b.glb()).string();
}

} // namespace wavepath::test
