// KHR_draco_mesh_compression and EXT_meshopt_compression, on data that the libraries' own encoders make here.
#include <cmath>
#include <random>

#include <draco/compression/encode.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "host/base/error.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::GltfBuilder;
using test::load;
using test::warning_count;

// A square of two triangles, with a colour by place.
const std::vector<float> kPositions = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
const std::vector<float> kColors = {0, 0, 1, 1, 0, 1, 1, 1, 1, 0, 1, 1};
const std::vector<std::array<std::uint32_t, 3>> kFaces = {{0, 1, 2}, {0, 2, 3}};

struct DracoAttribute {
  draco::GeometryAttribute::Type type;
  std::int8_t components;
  std::uint32_t unique_id;
  std::vector<float> values;
};

std::string draco_bytes(const std::vector<DracoAttribute>& attributes, draco::MeshEncoderMethod method) {
  draco::Mesh mesh;
  mesh.set_num_points(4);
  mesh.SetNumFaces(kFaces.size());
  for (std::uint32_t f = 0; f < kFaces.size(); ++f) {
    draco::Mesh::Face face;
    for (std::size_t k = 0; k < 3; ++k) face[k] = draco::PointIndex(kFaces[f][k]);
    mesh.SetFace(draco::FaceIndex(f), face);
  }
  for (const DracoAttribute& attribute : attributes) {
    const auto stride = sizeof(float) * static_cast<std::size_t>(attribute.components);
    draco::GeometryAttribute description;
    description.Init(attribute.type, nullptr, attribute.components, draco::DT_FLOAT32, false,
                     static_cast<std::int64_t>(stride), 0);
    draco::PointAttribute* stored = mesh.attribute(mesh.AddAttribute(description, true, 4));
    for (std::uint32_t i = 0; i < 4; ++i)
      stored->SetAttributeValue(draco::AttributeValueIndex(i),
                                &attribute.values[i * static_cast<std::size_t>(attribute.components)]);
    stored->set_unique_id(attribute.unique_id);
  }
  draco::Encoder encoder;
  encoder.SetEncodingMethod(method);
  draco::EncoderBuffer buffer;
  EXPECT_TRUE(encoder.EncodeMeshToBuffer(mesh, &buffer).ok());
  return {buffer.data(), buffer.size()};
}

const DracoAttribute kDracoPositions{draco::GeometryAttribute::POSITION, 3, 4, kPositions};
const DracoAttribute kDracoColors{draco::GeometryAttribute::COLOR, 3, 9, kColors};

// Positions and colours under the unique ids 4 and 9; accessors 0 to 2 are positions, colours and indices, without data
// of their own.
GltfBuilder compressed(draco::MeshEncoderMethod method = draco::MESH_SEQUENTIAL_ENCODING,
                       const std::vector<DracoAttribute>& attributes = {kDracoColors, kDracoPositions}) {
  GltfBuilder b;
  b.root["extensionsUsed"] = {"KHR_draco_mesh_compression"};
  b.add("accessors", {{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}});
  b.add("accessors", {{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}});
  b.add("accessors", {{"componentType", 5125}, {"type", "SCALAR"}, {"count", 6}});
  const json ids = {{"POSITION", 4}, {"COLOR_0", 9}};
  const json draco = {{"bufferView", b.view(draco_bytes(attributes, method))}, {"attributes", ids}};
  b.mesh_node({{"POSITION", 0}, {"COLOR_0", 1}},
              {{"indices", 2}, {"extensions", {{"KHR_draco_mesh_compression", draco}}}});
  return b;
}

// Two triangles that cover the square, with the colours of their places.
void expect_square(const Scene& scene) {
  const Mesh& mesh = scene.meshes.at(0);
  ASSERT_EQ(mesh.indices.size(), 6u);
  double area = 0.0;
  for (std::size_t i = 0; i < 6; i += 3) {
    const auto at = [&](std::size_t k) { return mesh.positions.at(mesh.indices[i + k]); };
    const glm::vec3 normal = glm::cross(at(1) - at(0), at(2) - at(0));
    EXPECT_GT(normal.z, 0.0f) << "turned over";
    area += 0.5 * normal.z;
  }
  EXPECT_NEAR(area, 1.0, 1e-6);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
    const glm::vec3 p = mesh.positions[i];
    EXPECT_EQ(mesh.colors.at(i), glm::vec4(p.x, p.y, 1, 1));
  }
}

TEST(GltfDraco, TrianglesOfEveryModeWithAndWithoutIndices) {
  for (const auto method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    for (const int mode : {4, 5, 6}) {
      for (const int index_count : {6, 4, 0}) { // as a list, as a strip, without
        if (mode == 4 && index_count == 4) continue;
        GltfBuilder b = compressed(method);
        b.primitive()["mode"] = mode;
        b.root["accessors"][2]["count"] = index_count;
        if (!index_count) b.primitive().erase("indices");
        SCOPED_TRACE(testing::Message() << "method " << method << ", mode " << mode << ", " << index_count
                                        << " indices");
        const Scene scene = load(b);
        expect_square(scene);
        EXPECT_TRUE(scene.warnings.empty());
      }
    }
  }
}

TEST(GltfDraco, PointsAndLinesAreLeftOut) {
  for (const int mode : {0, 1, 2, 3}) {
    GltfBuilder b = compressed();
    b.primitive()["mode"] = mode;
    EXPECT_EQ(warning_count(load(b), "points or lines"), 1u) << mode;
  }
}

// Draco data win over the accessors' own, which are for readers without Draco.
TEST(GltfDraco, FallbackDataAreIgnored) {
  GltfBuilder b = compressed();
  b.root["accessors"][0]["bufferView"] = b.root["accessors"][1]["bufferView"] = b.view(std::vector<float>(12, 7.0f));
  b.root["accessors"][2]["bufferView"] = b.view(std::vector<std::uint32_t>(6, 0u));
  const Scene scene = load(b);
  expect_square(scene);
  EXPECT_TRUE(scene.warnings.empty());
}

TEST(GltfDraco, AttributesBesideTheDracoData) {
  GltfBuilder b = compressed();
  json& ids = b.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"];
  ids.erase("COLOR_0");
  b.root["accessors"][1]["bufferView"] = b.view(kColors);
  expect_square(load(b));
  b.root["accessors"][1].erase("bufferView"); // nowhere
  const Scene black = load(b);
  EXPECT_EQ(black.meshes.at(0).colors.at(0), glm::vec4(0, 0, 0, 1));
  EXPECT_EQ(warning_count(black, "attribute that is missing in Draco data"), 1u);
  ids.erase("POSITION");
  EXPECT_THROW(load(b), Error);
}

TEST(GltfDraco, CountsOfAccessorsThatDiffer) {
  GltfBuilder b = compressed();
  b.root["accessors"][0]["count"] = 6; // as before equal vertices were joined
  b.root["accessors"][1]["count"] = 6;
  b.root["accessors"][2]["count"] = 9;
  const Scene scene = load(b);
  expect_square(scene);
  EXPECT_EQ(warning_count(scene, "count is not that of its Draco data"), 3u);
}

TEST(GltfDraco, ColorsOfThreeComponentsAreOpaque) {
  GltfBuilder b = compressed();
  b.root["accessors"][1]["type"] = "VEC4";
  expect_square(load(b));
}

TEST(GltfDraco, WhatDoesNotFitIsRefused) {
  GltfBuilder b = compressed();
  b.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"]["COLOR_0"] = 3;
  EXPECT_THROW(load(b), Error) << "no such id";
  b = compressed();
  b.primitive()["attributes"].erase("COLOR_0");
  EXPECT_THROW(load(b), Error) << "no accessor";
  b = compressed();
  b.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"] = {{"COLOR_0", 9}};
  b.root["accessors"][0] = {
      {"componentType", 5126}, {"type", "VEC3"}, {"count", 3}, {"bufferView", b.view(std::vector<float>(9))}};
  EXPECT_THROW(load(b), Error) << "fewer positions than the triangles have corners";
  b.primitive()["attributes"].erase("COLOR_0");
  b.primitive()["extensions"]["KHR_draco_mesh_compression"]["attributes"] = json::object();
  EXPECT_THROW(load(b), Error) << "and nothing else whose count could tell";
}

TEST(GltfDraco, NumbersThatAreNotFiniteAreMended) {
  DracoAttribute colors = kDracoColors;
  colors.values[3] = NAN;
  const Scene scene = load(compressed(draco::MESH_SEQUENTIAL_ENCODING, {colors, kDracoPositions}));
  EXPECT_EQ(warning_count(scene, "colours that are not finite"), 1u);
  expect_square(scene); // mended to one, which it was
}

// Whatever happens to the data: they are read, or refused by an Error.
TEST(GltfDraco, DamagedDataAreReadOrRefused) {
  std::mt19937 random(1);
  int accepted = 0, refused = 0;
  for (const auto method : {draco::MESH_SEQUENTIAL_ENCODING, draco::MESH_EDGEBREAKER_ENCODING}) {
    const GltfBuilder sound = compressed(method);
    for (int trial = 0; trial < 100; ++trial) {
      GltfBuilder b = sound;
      for (std::size_t edits = 1 + random() % 2; edits > 0; --edits)
        b.bytes[11 + random() % (b.bytes.size() - 11)] = static_cast<char>(random()); // behind the header
      try {
        load(b);
        ++accepted;
      } catch (const Error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(accepted, 20);
  EXPECT_GT(refused, 20);
}

// --- meshopt ---

// Appends a compressed view of `count` elements; returns it.
int meshopt_view(GltfBuilder& b, const std::string& contents, std::size_t count, std::size_t stride,
                 const std::string& mode, const std::string& filter = "NONE") {
  const int view = b.view(contents);
  json& item = b.root["bufferViews"][static_cast<unsigned>(view)];
  item["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", item["byteOffset"]},
                                                   {"byteLength", contents.size()},
                                                   {"byteStride", stride},
                                                   {"count", count},
                                                   {"mode", mode},
                                                   {"filter", filter}};
  return view;
}

std::string meshopt_attributes(const std::vector<float>& values, std::size_t count) {
  const std::size_t stride = values.size() / count * sizeof(float);
  std::string out(meshopt_encodeVertexBufferBound(count, stride), '\0');
  out.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(out.data()), out.size(), values.data(), count,
                                        stride));
  return out;
}

TEST(GltfMeshopt, AttributesTrianglesAndIndices) {
  const std::vector<unsigned int> indices = {0, 1, 2, 0, 2, 3};
  for (const char* mode : {"TRIANGLES", "INDICES"}) {
    GltfBuilder b;
    b.root["extensionsUsed"] = {"EXT_meshopt_compression"};
    std::vector<float> colors = kColors;
    colors[3] = INFINITY;
    for (const auto* values : {&kPositions, static_cast<const std::vector<float>*>(&colors)})
      b.add("accessors", {{"componentType", 5126},
                          {"type", "VEC3"},
                          {"count", 4},
                          {"bufferView", meshopt_view(b, meshopt_attributes(*values, 4), 4, 12, "ATTRIBUTES")}});
    const bool triangles = std::string(mode) == "TRIANGLES";
    std::string out(triangles ? meshopt_encodeIndexBufferBound(6, 4) : meshopt_encodeIndexSequenceBound(6, 4), '\0');
    auto* bytes = reinterpret_cast<unsigned char*>(out.data());
    out.resize(triangles ? meshopt_encodeIndexBuffer(bytes, out.size(), indices.data(), 6)
                         : meshopt_encodeIndexSequence(bytes, out.size(), indices.data(), 6));
    b.add(
        "accessors",
        {{"componentType", 5125}, {"type", "SCALAR"}, {"count", 6}, {"bufferView", meshopt_view(b, out, 6, 4, mode)}});
    b.mesh_node({{"POSITION", 0}, {"COLOR_0", 1}}, {{"indices", 2}});
    const Scene scene = load(b);
    expect_square(scene);
    EXPECT_EQ(warning_count(scene, "colours that are not finite"), 1u) << mode;
  }
}

// KHR_meshopt_compression is the same but for a newer encoding and a filter, which are refused by name.
TEST(GltfMeshopt, TheKhronosExtensionWhereItIsTheSame) {
  GltfBuilder b;
  const int view = meshopt_view(b, meshopt_attributes(kPositions, 4), 4, 12, "ATTRIBUTES");
  json& extensions = b.root["bufferViews"][static_cast<unsigned>(view)]["extensions"];
  extensions = {{"KHR_meshopt_compression", extensions["EXT_meshopt_compression"]}};
  b.root["extensionsRequired"] = b.root["extensionsUsed"] = {"KHR_meshopt_compression"};
  b.add("accessors", {{"componentType", 5126}, {"type", "VEC3"}, {"count", 4}, {"bufferView", view}});
  b.mesh_node({{"POSITION", 0}}, {{"indices", b.accessor<std::uint16_t>("SCALAR", test::kUshort, {0, 1, 2})}});
  const Scene scene = test::load(b);
  EXPECT_TRUE(scene.warnings.empty());
  EXPECT_EQ(scene.meshes.at(0).positions.at(1), glm::vec3(kPositions[3], kPositions[4], kPositions[5]));
  const auto problem = [&]() -> std::string {
    try {
      test::load(b);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  };
  extensions["KHR_meshopt_compression"]["filter"] = "COLOR";
  EXPECT_NE(problem().find("filter COLOR, which wavepath does not know"), std::string::npos) << problem();
  extensions["KHR_meshopt_compression"]["filter"] = "NONE";
  const std::size_t offset = b.root["bufferViews"][static_cast<unsigned>(view)]["byteOffset"];
  b.bytes[offset] = static_cast<char>(0xa1);
  EXPECT_NE(problem().find("version 1, of which wavepath knows version 0"), std::string::npos) << problem();
}

} // namespace
} // namespace wavepath
