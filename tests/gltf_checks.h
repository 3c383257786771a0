// A valid glTF file to start from, loading of built files, and checks of what came out, for the glTF tests.
#pragma once

#include <string>

#include <gtest/gtest.h>

#include "host/scene/gltf/gltf.h"
#include "tests/gltf_builder.h"

namespace wavepath::test {

// A PNG of one texel (64, 128, 192).
inline constexpr char kPng[] =
    "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\x00\x01\x00\x00\x00\x01"
    "\x08\x02\x00\x00\x00\x90\x77\x53\xde\x00\x00\x00\x0c\x49\x44\x41\x54\x78\xda\x63\x70\x68\x38\x00"
    "\x00\x02\x84\x01\x81\x18\x6a\x74\x87\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";

// A valid file with everything in it that the cases damage: indexed triangle, normal, uv, skin, morph target, texture,
// camera, animation. Accessors: 0 positions, 1 indices, 2 normals, 3 uvs, 4 joints, 5 weights, 6 times, 7 translations.
inline GltfBuilder full() {
  GltfBuilder b = GltfBuilder::triangle();
  auto& attributes = b.primitive()["attributes"];
  b.primitive()["indices"] = b.accessor<std::uint16_t>("SCALAR", kUshort, {0, 1, 2});
  attributes["NORMAL"] = b.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  attributes["TEXCOORD_0"] = b.floats("VEC2", {0, 0, 1, 0, 0, 1});
  attributes["JOINTS_0"] = b.accessor<std::uint8_t>("VEC4", kUbyte, {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  attributes["WEIGHTS_0"] = b.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  const int times = b.floats("SCALAR", {0, 1});
  const int translations = b.floats("VEC3", {0, 0, 0, 1, 0, 0});
  b.primitive()["targets"] = {{{"POSITION", 0}}};
  b.root["meshes"][0]["weights"] = {0.5};
  b.add("nodes", {{"translation", {0, 0, 1}}}); // node 1: the joint
  b.root["nodes"][0]["skin"] = b.add("skins", {{"joints", {1}}});
  b.add("nodes",
        {{"camera", b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1}, {"znear", 0.1}}}})}});
  b.add("animations", {{"name", "move"},
                       {"samplers", {{{"input", times}, {"output", translations}}}},
                       {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}});
  b.add("images", {{"bufferView", b.view(std::string(kPng, sizeof(kPng) - 1))}, {"mimeType", "image/png"}});
  b.add("samplers", {{"magFilter", 9729}});
  b.add("textures", {{"source", 0}, {"sampler", 0}});
  b.primitive()["material"] = b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  b.add("scenes", {{"nodes", {0, 1, 2}}});
  b.root["scene"] = 0;
  return b;
}

inline Scene load(const GltfBuilder& builder, const LoadOptions& options = {}) {
  TempFolder folder;
  return load_gltf(folder.write("scene.gltf", builder.json()), options);
}

inline std::size_t warning_count(const Scene& scene, const std::string& text) {
  std::size_t count = 0;
  for (const auto& [warning, times] : scene.warnings.counts()) {
    if (warning.find(text) != std::string::npos) count += times;
  }
  return count;
}

inline void expect_near(const glm::dvec3& actual, const glm::dvec3& expected, double tolerance = 1e-6) {
  EXPECT_LE(glm::length(actual - expected), tolerance)
      << actual.x << " " << actual.y << " " << actual.z << " instead of " << expected.x << " " << expected.y << " "
      << expected.z;
}

} // namespace wavepath::test
