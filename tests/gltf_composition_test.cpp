// glTF import: containers of version 3, and files that are instances in other files (draft of glTF 2.1).
#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::expect_near;
using test::GltfBuilder;
using test::TempFolder;
using test::warning_count;

std::string refusal(const std::function<void()>& load) {
  try {
    load();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

// ---- GLB version 3

std::string word64(std::uint64_t value) { return std::string(reinterpret_cast<const char*>(&value), 8); }

struct Chunk {
  std::string type, contents;
  std::uint32_t encoding = 0;
};

std::string glb3(const std::vector<Chunk>& chunks) {
  std::string body;
  for (const Chunk& chunk : chunks) {
    body += chunk.type + GltfBuilder::word(chunk.encoding) + word64(chunk.contents.size()) + chunk.contents;
    body.resize((body.size() + 7) / 8 * 8); // behind the chunk
  }
  return "glTF" + GltfBuilder::word(3) + word64(16 + body.size()) + body;
}

const std::string kBin("BIN\0", 4);

std::string load_error(const std::string& contents) {
  const TempFolder folder;
  return refusal([&] { load_gltf(folder.write("a.glb", contents)); });
}

TEST(GltfComposition, Version3HasTheSameScene) {
  const GltfBuilder b = test::full();
  const TempFolder folder;
  const Scene two = load_gltf(folder.write("2.glb", b.glb()));
  const Scene three = load_gltf(folder.write("3.glb", glb3({{"JSON", b.json("")}, {kBin, b.bytes}})));
  EXPECT_EQ(three.meshes.at(0).positions, two.meshes.at(0).positions);
  EXPECT_EQ(three.images.at(0).bytes, two.images.at(0).bytes);
}

// Buffers name chunks, which may come before the JSON; what is unknown is left out.
TEST(GltfComposition, Version3BuffersNameTheirChunks) {
  GltfBuilder b = GltfBuilder::triangle();
  json root = json::parse(b.json(""));
  root["asset"]["version"] = "2.1";
  root["buffers"] = {{{"byteLength", 4}, {"uri", "data:,abcd"}}, {{"byteLength", b.bytes.size()}, {"chunk", 1}}};
  for (json& view : root["bufferViews"]) view["buffer"] = 1;
  const TempFolder folder;
  const std::vector<Chunk> chunks = {
      {kBin, "not this one"}, {kBin, b.bytes}, {"WHAT", "?", 7}, {"JSON", root.dump()}, {"JSON", "{}"}};
  EXPECT_EQ(load_gltf(folder.write("a.glb", glb3(chunks))).meshes.at(0).positions[1], glm::vec3(1, 0, 0));
  root["buffers"][1]["chunk"] = 2;
  EXPECT_NE(load_error(glb3({chunks[0], chunks[1], chunks[2], {"JSON", root.dump()}})).find("no BIN chunk"),
            std::string::npos);
  root["buffers"][1]["uri"] = "data:,";
  EXPECT_NE(load_error(glb3({chunks[0], chunks[1], chunks[2], {"JSON", root.dump()}})).find("both a chunk and a URI"),
            std::string::npos);
}

TEST(GltfComposition, Version3ThatIsDamagedIsRefused) {
  const GltfBuilder b = GltfBuilder::triangle();
  const std::string text = b.json("");
  EXPECT_NE(load_error(glb3({{"JSON", text}, {kBin, b.bytes, 5}})).find("encoding 5"), std::string::npos);
  EXPECT_NE(load_error(glb3({{"JSON", text, 1}})).find("encoding 1"), std::string::npos);
  EXPECT_NE(load_error(glb3({{kBin, b.bytes}})).find("no JSON chunk"), std::string::npos);
  std::string whole = glb3({{"JSON", text}, {kBin, b.bytes}});
  EXPECT_NE(load_error(whole.substr(0, whole.size() - 8)).find("cut short"), std::string::npos);
  std::string long_chunk = whole;
  long_chunk.replace(24, 8, word64(std::uint64_t{1} << 62));
  EXPECT_NE(load_error(long_chunk).find("reaches beyond"), std::string::npos);
  whole.replace(4, 4, GltfBuilder::word(4));
  EXPECT_NE(load_error(whole).find("GLB version 4"), std::string::npos);
}

TEST(GltfComposition, MinimumVersionOf21IsRead) {
  GltfBuilder b = GltfBuilder::triangle();
  b.root["asset"] = {{"version", "2.1"}, {"minVersion", "2.1"}};
  EXPECT_EQ(test::load(b).instances.size(), 1u);
  b.root["asset"] = {{"version", "2.2"}, {"minVersion", "2.2"}};
  EXPECT_THROW(test::load(b), Error);
}

// ---- external assets

// A file of one scene with everything that has a number: a textured triangle of a skin, a lamp, a camera, an animation.
GltfBuilder asset() {
  GltfBuilder b = test::full();
  b.root["asset"]["version"] = "2.1";
  b.root["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"name", "lamp"}, {"intensity", 3}}};
  b.root["nodes"][1]["extensions"]["KHR_lights_punctual"]["light"] = 0;
  b.root["extensionsUsed"] = {"KHR_lights_punctual"};
  b.root["scenes"] = {{{"nodes", {0, 1, 2}}}};
  b.root["scene"] = 0;
  return b;
}

json instance(int number, double x) { return {{"externalAsset", number}, {"translation", {x, 0, 0}}}; }

// A file that shows asset.glb three times besides a mesh and a lamp of its own.
json composition() {
  GltfBuilder b = asset();
  json root = json::parse(b.json());
  root["files"] = {{{"uri", "sub/asset.glb"}, {"mimeType", "model/gltf-binary"}}};
  root["externalAssets"] = {{{"file", 0}}, {{"file", 0}}};
  for (int i = 0; i < 3; ++i) root["nodes"].push_back(instance(i == 2 ? 1 : 0, 10.0 * (i + 1)));
  root["scenes"][0]["nodes"] = {0, 1, 2, 3, 4, 5};
  return root;
}

TEST(GltfComposition, AssetsAreInstances) {
  const TempFolder folder;
  folder.write("sub/asset.glb", asset().glb());
  const auto path = folder.write("whole.gltf", composition().dump());
  const Scene scene = load_gltf(path);
  EXPECT_TRUE(scene.warnings.empty());
  ASSERT_EQ(scene.instances.size(), 4u);
  ASSERT_EQ(scene.lights.size(), 4u);
  EXPECT_EQ(scene.cameras.size(), 4u);
  EXPECT_EQ(scene.images.size(), 2u) << "its own, and one of the asset";
  EXPECT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(std::ranges::count(scene.files, (folder.path() / "sub/asset.glb").string()), 1);
  // Skins are in world space; each copy has its own joints, which are lamps too.
  for (std::size_t i = 0; i < 4; ++i) {
    const double x = 10.0 * static_cast<double>(i);
    expect_near(scene.lights[i].position, {x, 0, 1});
    const Mesh& mesh = scene.meshes.at(scene.instances[i].mesh);
    expect_near(mesh.positions.at(1), glm::dvec3(x + 1.5, 0, 1)); // a target of weight 1/2 along x
    expect_near(scene.cameras[i].world_from_camera[3], {x, 0, 0});
  }
}

TEST(GltfComposition, AnimationsOfAssetsMoveEveryCopy) {
  const TempFolder folder;
  folder.write("sub/asset.glb", asset().glb());
  json root = composition();
  root["animations"][0]["name"] = "outer";
  const auto path = folder.write("whole.gltf", root.dump());
  const Scene scene = load_gltf(path, {.animation = "move", .at = 1.0});
  expect_near(scene.lights.at(0).position, {0, 0, 1});
  for (int i = 1; i < 4; ++i) expect_near(scene.lights.at(static_cast<std::size_t>(i)).position, {10.0 * i + 1, 0, 0});
  expect_near(load_gltf(path, {.animation = "outer", .at = 1.0}).lights.at(0).position, {1, 0, 0});
}

TEST(GltfComposition, AssetsWithinAssetsByEveryKindOfReference) {
  const TempFolder folder;
  GltfBuilder leaf = GltfBuilder::triangle();
  leaf.root["scenes"] = {{{"nodes", {0}}}};
  leaf.root["scene"] = 0;
  folder.write("a/leaf.gltf", leaf.json("leaf.bin"));
  folder.write("a/leaf.bin", leaf.bytes);
  // Within a: by a URI that is relative to the asset, in a data URI, in a buffer view.
  GltfBuilder middle;
  const std::string inside = leaf.glb();
  middle.root["files"] = {
      {{"uri", "leaf.gltf"}, {"mimeType", "model/gltf+json"}},
      {{"uri", "data:model/gltf-binary;base64," + GltfBuilder::base64(inside)}, {"mimeType", "model/gltf-binary"}},
      {{"bufferView", middle.view(inside)}, {"mimeType", "model/gltf-binary"}}};
  for (int i = 0; i < 3; ++i) {
    middle.add("externalAssets", {{"file", i}});
    middle.add("nodes", instance(i, i + 1.0));
  }
  middle.add("nodes", {{"children", {0, 1, 2}}, {"translation", {0, 1, 0}}});
  middle.root["scenes"] = {{{"nodes", {3}}}};
  middle.root["scene"] = 0;
  folder.write("a/middle.glb", middle.glb());
  const json root = {{"asset", {{"version", "2.1"}}},
                     {"files", {{{"uri", "a/middle.glb"}, {"mimeType", "model/gltf-binary"}}}},
                     {"externalAssets", {{{"file", 0}}}},
                     {"nodes", {instance(0, 100.0)}}};
  const Scene scene = load_gltf(folder.write("whole.gltf", root.dump()));
  ASSERT_EQ(scene.instances.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    expect_near(scene.instances[i].world_from_object[3], {101.0 + static_cast<double>(i), 1, 0});
    EXPECT_EQ(scene.meshes.at(scene.instances[i].mesh).positions[1], glm::vec3(1, 0, 0));
  }
}

// A file above lends its own files to an asset that asks for others.
TEST(GltfComposition, Aliases) {
  const TempFolder folder;
  GltfBuilder leaf = GltfBuilder::triangle();
  leaf.root["scenes"] = {{{"nodes", {0}}}};
  leaf.root["scene"] = 0;
  folder.write("leaf.gltf", leaf.json("shape.bin"));
  GltfBuilder other;
  other.floats("VEC3", {0, 0, 0, 5, 0, 0, 0, 5, 0});
  folder.write("b/other.bin", other.bytes);
  const auto whole = [&](json target) {
    GltfBuilder b;
    const int view = b.view(other.bytes);
    if (target.contains("bufferView")) target["bufferView"] = view;
    b.root["files"] = {
        {{"uri", "leaf.gltf"}, {"mimeType", "model/gltf+json"}, {"aliases", {{{"alias", "shape.bin"}, {"file", 1}}}}},
        target};
    b.root["externalAssets"] = {{{"file", 0}}};
    b.add("nodes", instance(0, 0.0));
    return load_gltf(folder.write("whole.gltf", b.json()));
  };
  const json type = {{"mimeType", "application/gltf-buffer"}};
  json by_uri = type, by_view = type;
  by_uri["uri"] = "b/other.bin";
  by_view["bufferView"] = 0;
  EXPECT_EQ(whole(by_uri).meshes.at(0).positions[1], glm::vec3(5, 0, 0));
  EXPECT_EQ(whole(by_view).meshes.at(0).positions[1], glm::vec3(5, 0, 0));
}

TEST(GltfComposition, VariantsOfOneNameAreOne) {
  const TempFolder folder;
  const auto with_variants = [](GltfBuilder b, const std::vector<const char*>& names) {
    b.root["extensions"]["KHR_materials_variants"]["variants"] = json::array();
    for (const char* name : names)
      b.root["extensions"]["KHR_materials_variants"]["variants"].push_back({{"name", name}});
    b.add("materials", {{"name", "chosen"}});
    const std::size_t last = names.size() - 1;
    b.primitive()["extensions"]["KHR_materials_variants"]["mappings"] = {
        {{"material", b.root["materials"].size() - 1}, {"variants", {last}}}};
    return b;
  };
  folder.write("sub/asset.glb", with_variants(asset(), {"x", "both"}).glb());
  json root = json::parse(with_variants(asset(), {"both"}).json());
  const json parts = composition();
  for (const char* list : {"files", "externalAssets", "nodes", "scenes"}) root[list] = parts[list];
  const auto path = folder.write("whole.gltf", root.dump());
  EXPECT_EQ(load_gltf(path).variants, (std::vector<std::string>{"both", "x"}));
  const Scene scene = load_gltf(path, {.variant = "both"});
  for (const Instance& i : scene.instances)
    EXPECT_EQ(scene.materials.at(scene.meshes.at(i.mesh).primitives.at(0).material).name, "chosen");
}

TEST(GltfComposition, WhatCannotBeShownIsRefusedOrTold) {
  const TempFolder folder;
  const auto loaded = [&](const json& root) { return load_gltf(folder.write("whole.gltf", root.dump())); };
  const auto problem = [&](const json& root) { return refusal([&] { loaded(root); }); };
  json root = {{"asset", {{"version", "2.1"}}},
               {"files", {{{"uri", "asset.glb"}, {"mimeType", "model/gltf-binary"}}}},
               {"externalAssets", {{{"file", 0}}}},
               {"nodes", {instance(0, 0.0)}}};
  EXPECT_NE(problem(root).find("'asset.glb' is not there"), std::string::npos) << problem(root);
  GltfBuilder b = GltfBuilder::triangle(); // without a scene
  folder.write("asset.glb", b.glb());
  EXPECT_EQ(warning_count(loaded(root), "external asset without a default scene"), 1u);
  b.root["extensionsRequired"] = {"ACME_needed"};
  folder.write("asset.glb", b.glb());
  EXPECT_NE(problem(root).find("requires ACME_needed"), std::string::npos);
  json self = root;
  self["files"][0] = {{"uri", "whole.gltf"}, {"mimeType", "model/gltf+json"}};
  EXPECT_NE(problem(self).find("contains itself"), std::string::npos);
  json outside = root;
  outside["files"][0]["uri"] = "../asset.glb";
  EXPECT_NE(problem(outside).find("outside the folder"), std::string::npos);
  outside["files"][0]["uri"] = "https://example.org/asset.glb";
  EXPECT_NE(problem(outside).find("outside the folder"), std::string::npos);
  json both = root;
  both["nodes"][0]["mesh"] = 0;
  both["meshes"] = {{{"primitives", json::array()}}};
  EXPECT_NE(problem(both).find("both a mesh and an external asset"), std::string::npos);
  json wrong = root;
  wrong["files"][0]["mimeType"] = "image/png";
  EXPECT_NE(problem(wrong).find("of type 'image/png'"), std::string::npos);
  wrong["externalAssets"][0]["file"] = 1;
  EXPECT_THROW(loaded(wrong), Error);
}

// Ten times ten times ten ... nodes of a few small files.
TEST(GltfComposition, ManyCopiesOfManyCopiesAreRefused) {
  const TempFolder folder;
  GltfBuilder leaf = GltfBuilder::triangle();
  leaf.root["scenes"] = {{{"nodes", {0}}}};
  leaf.root["scene"] = 0;
  folder.write("0.glb", leaf.glb());
  for (int level = 1; level <= 8; ++level) {
    GltfBuilder b;
    b.root["files"] = {{{"uri", std::to_string(level - 1) + ".glb"}, {"mimeType", "model/gltf-binary"}}};
    b.root["externalAssets"] = {{{"file", 0}}};
    json nodes = json::array();
    for (int i = 0; i < 100; ++i) nodes.push_back(b.add("nodes", instance(0, i)));
    b.root["scenes"] = {{{"nodes", nodes}}};
    b.root["scene"] = 0;
    folder.write(std::to_string(level) + ".glb", b.glb());
  }
  EXPECT_NE(refusal([&] { load_gltf(folder.path() / "8.glb"); }).find("more than 1000000 nodes"), std::string::npos);
}

} // namespace
} // namespace wavepath
