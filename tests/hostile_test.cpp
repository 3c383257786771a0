// Malformed and hostile glTF files: each is refused with one line that names the file, the problem and a remedy.
#include <algorithm>
#include <functional>
#include <random>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "tests/gltf_checks.h"

namespace wavepath {
namespace {

using nlohmann::json;
using test::full;
using test::GltfBuilder;
using test::TempFolder;

// A PNG whose header claims 60000 x 60000 texels: 14 GB if believed.
const char kHugePng[] =
    "\x89\x50\x4e\x47\x0d\x0a\x1a\x0a\x00\x00\x00\x0d\x49\x48\x44\x52\x00\x00\xea\x60\x00\x00\xea\x60"
    "\x08\x06\x00\x00\x00\x80\xd2\x75\x42\x00\x00\x00\x0b\x49\x44\x41\x54\x78\xda\x63\x60\x40\x05\x00"
    "\x00\x10\x00\x01\xaa\x19\xf8\x82\x00\x00\x00\x00\x49\x45\x4e\x44\xae\x42\x60\x82";

// Loads the file and returns the message of the Error, or what happened instead.
std::string refusal(const std::filesystem::path& path, const LoadOptions& options = {}) {
  try {
    load_gltf(path, options);
  } catch (const Error& error) {
    return error.what();
  } catch (const std::exception& exception) {
    return std::string("not an Error: ") + exception.what();
  }
  return "was accepted";
}

// The message must name file, problem (with `expected` in it) and remedy, on one line of readable length.
void expect_refused(const std::filesystem::path& path, const std::string& expected, const LoadOptions& options = {}) {
  const std::string message = refusal(path, options);
  EXPECT_TRUE(message.starts_with(path.string() + ": ")) << message;
  const std::string rest = message.substr(std::min(message.size(), path.string().size() + 2));
  const auto remedy = rest.find("; ");
  EXPECT_NE(remedy, std::string::npos) << message;
  EXPECT_NE(rest.substr(0, remedy).find(expected), std::string::npos) << message << "\nexpected: " << expected;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  EXPECT_LT(rest.size(), 400u) << message;
}

struct Case {
  std::string name, expected;
  std::function<void(json&)> damage;
};

void PrintTo(const Case& value, std::ostream* out) { *out << value.name; }

class DamagedDocument : public testing::TestWithParam<Case> {};

TEST_P(DamagedDocument, IsRefused) {
  TempFolder folder;
  GltfBuilder builder = full();
  GetParam().damage(builder.root);
  LoadOptions options;
  options.animation = "0";
  expect_refused(folder.write("damaged.gltf", builder.json()), GetParam().expected, options);
}

const Case kCases[] = {
    {"VersionMissing", "asset.version is missing", [](json& d) { d["asset"].erase("version"); }},
    {"VersionOne", "glTF version 1.0", [](json& d) { d["asset"]["version"] = "1.0"; }},
    {"VersionThree", "glTF version 3.0", [](json& d) { d["asset"]["version"] = "3.0"; }},
    {"VersionNotANumber", "asset.version is '2' instead of MAJOR.MINOR", [](json& d) { d["asset"]["version"] = "2"; }},
    {"VersionWithThreeParts", "asset.version is '2.0.1'", [](json& d) { d["asset"]["version"] = "2.0.1"; }},
    {"VersionSigned", "asset.version is '2.-1'", [](json& d) { d["asset"]["version"] = "2.-1"; }},
    {"VersionTooNew", "needs a reader of glTF 2.2",
     [](json& d) {
       d["asset"] = {{"version", "2.2"}, {"minVersion", "2.2"}};
     }},
    {"VersionMuchTooNew", "needs a reader of glTF 3.0",
     [](json& d) {
       d["asset"] = {{"version", "3.1"}, {"minVersion", "3.0"}};
     }},
    {"VersionBelowItsLeast", "asset.minVersion is above asset.version",
     [](json& d) { d["asset"]["minVersion"] = "2.1"; }},
    {"LeastVersionNotANumber", "asset.minVersion is 'two'", [](json& d) { d["asset"]["minVersion"] = "two"; }},
    {"LeastVersionNotAString", "asset.minVersion is not a string", [](json& d) { d["asset"]["minVersion"] = 2.0; }},
    {"AssetMissing", "asset is missing", [](json& d) { d.erase("asset"); }},
    {"NodesNotAList", "nodes is not a JSON array", [](json& d) { d["nodes"] = 3; }},
    {"NodeNotAnObject", "nodes[1] is not a JSON object", [](json& d) { d["nodes"][1] = "x"; }},
    {"NegativeIndex", "nodes[0].mesh is -1", [](json& d) { d["nodes"][0]["mesh"] = -1; }},
    {"FractionalIndex", "nodes[0].mesh is not a whole number", [](json& d) { d["nodes"][0]["mesh"] = 0.5; }},
    {"MeshOutOfRange", "nodes[0].mesh is 7, but there are 1 meshes", [](json& d) { d["nodes"][0]["mesh"] = 7; }},
    {"ChildOutOfRange", "nodes[0].children[0] is 99", [](json& d) { d["nodes"][0]["children"] = {99}; }},
    {"NodeIsItsOwnChild", "cycle",
     [](json& d) {
       d["nodes"][1]["children"] = {1};
       d["scenes"][0]["nodes"] = {0};
     }},
    {"NodesInARing", "cycle",
     [](json& d) {
       d["nodes"][1]["children"] = {2};
       d["nodes"][2]["children"] = {1};
       d["scenes"][0]["nodes"] = {0};
     }},
    {"TwoParents", "node 1 has two parents",
     [](json& d) {
       d["nodes"][0]["children"] = {1};
       d["nodes"][2]["children"] = {1};
     }},
    {"SceneListsAChild", "child of another node", [](json& d) { d["nodes"][0]["children"] = {1}; }},
    {"SceneListsTwice", "twice",
     [](json& d) {
       d["scenes"][0]["nodes"] = {0, 0};
     }},
    {"SceneOutOfRange", "scene is 4", [](json& d) { d["scene"] = 4; }},
    {"MatrixTooShort", "nodes[1].matrix has 3 numbers instead of 16",
     [](json& d) {
       d["nodes"][1]["matrix"] = {1, 2, 3};
     }},
    {"MatrixWithNull", "nodes[1].translation is not a list of numbers",
     [](json& d) {
       d["nodes"][1]["translation"] = {0, nullptr, 0};
     }},
    {"ViewBeyondBuffer", "buffer view 0 reaches beyond", [](json& d) { d["bufferViews"][0]["byteLength"] = 1000000; }},
    {"ViewOffsetOverflows", "bufferViews[0].byteOffset is 18446744073709551615",
     [](json& d) { d["bufferViews"][0]["byteOffset"] = 18446744073709551615u; }},
    {"ViewOfMissingBuffer", "bufferViews[0].buffer is 5", [](json& d) { d["bufferViews"][0]["buffer"] = 5; }},
    {"StrideNotAllowed", "byteStride", [](json& d) { d["bufferViews"][0]["byteStride"] = 7; }},
    {"StrideTooSmall", "larger than the stride", [](json& d) { d["bufferViews"][0]["byteStride"] = 4; }},
    {"AccessorBeyondView", "reaches beyond the end of buffer view 0", [](json& d) { d["accessors"][0]["count"] = 4; }},
    {"AccessorOffsetBeyondView", "reaches beyond the end of buffer view 0",
     [](json& d) { d["accessors"][0]["byteOffset"] = 9007199254740992; }},
    {"FourBillionElements", "reaches beyond", [](json& d) { d["accessors"][0]["count"] = 4000000000u; }},
    {"FourBillionZeros", "4000000000 elements, but no data",
     [](json& d) {
       d["accessors"][0].erase("bufferView");
       d["accessors"][0]["count"] = 4000000000u;
     }},
    {"CountsThatOverflow", "accessors[0].count is", [](json& d) { d["accessors"][0]["count"] = 9223372036854775807; }},
    {"UnknownComponentType", "component type", [](json& d) { d["accessors"][0]["componentType"] = 5124; }},
    {"NonsenseComponentType", "componentType", [](json& d) { d["accessors"][0]["componentType"] = 77; }},
    {"UnknownType", "VEC9", [](json& d) { d["accessors"][0]["type"] = "VEC9"; }},
    {"PositionsOfTwoComponents", "POSITION (accessor 3) does not have 3 components",
     [](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 3; }},
    {"NormalsOfOtherCount", "NORMAL (accessor 7) has 2 elements, but POSITION has 3",
     [](json& d) { d["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] = 7; }},
    {"IndexBeyondVertices", "index 2 is out of range: there are 2 vertices",
     [](json& d) {
       for (const int i : {0, 2, 3, 4, 5}) d["accessors"][static_cast<unsigned>(i)]["count"] = 2;
     }},
    {"FloatIndices", "indices that are not unsigned integers",
     [](json& d) { d["meshes"][0]["primitives"][0]["indices"] = 6; }},
    {"TwoCorners", "2 corners", [](json& d) { d["accessors"][1]["count"] = 2; }},
    {"UnknownMode", "unknown mode 9", [](json& d) { d["meshes"][0]["primitives"][0]["mode"] = 9; }},
    {"AttributesMissing", "primitives[0].attributes is missing",
     [](json& d) { d["meshes"][0]["primitives"][0].erase("attributes"); }},
    {"MaterialOutOfRange", "material is 3", [](json& d) { d["meshes"][0]["primitives"][0]["material"] = 3; }},
    {"MorphTargetOfOtherCount", "has 2 elements, but POSITION has 3",
     [](json& d) { d["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 7; }},
    {"SparseIndexBeyondEnd", "sparse index 2 beyond its end",
     [](json& d) {
       d["accessors"][7]["sparse"] = {
           {"count", 3}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}, {"values", {{"bufferView", 2}}}};
     }},
    {"SparseBeyondView", "sparse data beyond the end of buffer view 1",
     [](json& d) {
       d["accessors"][0]["sparse"] = {{"count", 2000000000},
                                      {"indices", {{"bufferView", 1}, {"componentType", 5125}}},
                                      {"values", {{"bufferView", 2}}}};
     }},
    {"SparseWithoutValues", "accessors[0].sparse.values is missing",
     [](json& d) {
       d["accessors"][0]["sparse"] = {{"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5123}}}};
     }},
    {"SkinWithoutJoints", "skin 0 has no joints", [](json& d) { d["skins"][0]["joints"] = json::array(); }},
    {"SkinWithFewMatrices", "inverse bind matrix", [](json& d) { d["skins"][0]["inverseBindMatrices"] = 0; }},
    {"SkinWithoutWeights", "JOINTS_0",
     [](json& d) { d["meshes"][0]["primitives"][0]["attributes"].erase("WEIGHTS_0"); }},
    {"JointOutOfRange", "joint that the skin does not have",
     [](json& d) { d["accessors"][4]["bufferView"] = 8; }}, // the image: its bytes are large numbers
    {"AnimationSamplerOutOfRange", "has no sampler", [](json& d) { d["animations"][0]["channels"][0]["sampler"] = 3; }},
    {"AnimationCountsDiffer", "does not fit its 2 times",
     [](json& d) { d["animations"][0]["samplers"][0]["output"] = 0; }},
    {"AnimationTimesFall", "times that do not increase",
     [](json& d) { d["accessors"][6]["bufferView"] = d["accessors"][0]["bufferView"]; }},
    {"AnimationInterpolation", "unknown interpolation 'WAVY'",
     [](json& d) { d["animations"][0]["samplers"][0]["interpolation"] = "WAVY"; }},
    {"TextureOutOfRange", "index is 12, but there are 1 textures",
     [](json& d) { d["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 12; }},
    {"ImageOutOfRange", "textures[0].source is 2", [](json& d) { d["textures"][0]["source"] = 2; }},
    {"SamplerOutOfRange", "textures[0].sampler is 2", [](json& d) { d["textures"][0]["sampler"] = 2; }},
    {"WrapModeUnknown", "unknown wrap mode 1", [](json& d) { d["samplers"][0]["wrapS"] = 1; }},
    {"ImageIsNoImage", "neither PNG nor JPEG nor WebP", [](json& d) { d["images"][0]["bufferView"] = 0; }},
    {"ImageCutShort", "damaged or cut short", [](json& d) { d["bufferViews"][8]["byteLength"] = 40; }},
    {"ImageWithoutData", "neither a URI nor a buffer view", [](json& d) { d["images"][0] = json::object(); }},
    {"TextureWithoutImage", "texture 0 has no image", [](json& d) { d["textures"][0].erase("source"); }},
    {"TextureOfUnknownKind", "texture 0 needs MSFT_texture_dds",
     [](json& d) {
       d["textures"][0].erase("source");
       d["textures"][0]["extensions"]["MSFT_texture_dds"]["source"] = 0;
     }},
    {"BasisImageOutOfRange", "textures[0].extensions.KHR_texture_basisu.source is 5",
     [](json& d) { d["textures"][0]["extensions"]["KHR_texture_basisu"]["source"] = 5; }},
    {"AlphaModeUnknown", "alphaMode 'GLASSY'", [](json& d) { d["materials"][0]["alphaMode"] = "GLASSY"; }},
    {"RequiredExtension", "requires EXT_from_tomorrow",
     [](json& d) { d["extensionsRequired"] = {"EXT_from_tomorrow"}; }},
    {"CameraWithoutAngle", "yfov is missing", [](json& d) { d["cameras"][0]["perspective"].erase("yfov"); }},
    {"CameraWithoutLens", "erspective camera", [](json& d) { d["cameras"][0].erase("perspective"); }},
    {"CameraOfNoAngle", "field of view", [](json& d) { d["cameras"][0]["perspective"]["yfov"] = 0; }},
    {"LightOutOfRange", "light is 0, but there are 0",
     [](json& d) { d["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0; }},
    {"LightUnknown", "unknown type 'laser'",
     [](json& d) {
       d["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "laser"}}};
       d["nodes"][0]["extensions"]["KHR_lights_punctual"]["light"] = 0;
     }},
    {"AbsurdBuffer", "instead of 9007199254740992",
     [](json& d) {
       d["bufferViews"][0]["buffer"] = 1;
       d["buffers"] = {{{"byteLength", 9007199254740992}, {"uri", "data:;base64,AAAA"}}};
     }},
    {"MissingBufferFile", "'gone.bin' is not there",
     [](json& d) {
       d["bufferViews"][0]["buffer"] = 1;
       d["buffers"] = {{{"byteLength", 36}, {"uri", "gone.bin"}}};
     }},
    {"DataUriMalformed", "malformed data URI",
     [](json& d) {
       d["bufferViews"][0]["buffer"] = 1;
       d["buffers"] = {{{"byteLength", 36}, {"uri", "data:;base64,!!!"}}};
     }},
    {"EscapingName", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "../secret.png"}};
     }},
    {"EscapingInside", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "textures/../../secret.png"}};
     }},
    {"EscapingEncoded", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "%2e%2e/secret.png"}};
     }},
    {"EscapingEncodedSlash", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "a%2f..%2f..%2fsecret.png"}};
     }},
    {"EscapingBackslash", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "..\\secret.png"}};
     }},
    {"AbsoluteName", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "/etc/passwd"}};
     }},
    {"EncodedAbsoluteName", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "%2Fetc%2Fpasswd"}};
     }},
    {"NetworkName", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "http://example.com/a.png"}};
     }},
    {"ZeroByteInName", "outside the folder",
     [](json& d) {
       d["images"][0] = {{"uri", "a.png%00.exe"}};
     }},
    {"MeshoptCountAbsurd", "meshopt mode, stride or count",
     [](json& d) {
       d["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
           {"buffer", 0}, {"byteLength", 20}, {"byteStride", 12}, {"count", 2000000000}, {"mode", "ATTRIBUTES"}};
     }},
    {"MeshoptStrideOdd", "meshopt mode, stride or count",
     [](json& d) {
       d["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
           {"buffer", 0}, {"byteLength", 20}, {"byteStride", 3}, {"count", 3}, {"mode", "ATTRIBUTES"}};
     }},
    {"MeshoptDamaged", "damaged meshopt data",
     [](json& d) {
       d["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
           {"buffer", 0}, {"byteLength", 30}, {"byteStride", 12}, {"count", 3}, {"mode", "ATTRIBUTES"}};
     }},
    {"MeshoptFilterMisplaced", "meshopt filter",
     [](json& d) {
       d["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
           {"buffer", 0}, {"byteLength", 30},     {"byteStride", 12},
           {"count", 3},  {"mode", "ATTRIBUTES"}, {"filter", "QUATERNION"}};
     }},
    {"MeshoptBeyondBuffer", "beyond",
     [](json& d) {
       d["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = {
           {"buffer", 0}, {"byteLength", 100000}, {"byteStride", 12}, {"count", 3}, {"mode", "ATTRIBUTES"}};
     }},
    {"DracoDamaged", "Draco data cannot be decoded",
     [](json& d) {
       d["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
           {"bufferView", 0}, {"attributes", {{"POSITION", 0}}}};
     }},
};

INSTANTIATE_TEST_SUITE_P(Hostile, DamagedDocument, testing::ValuesIn(kCases),
                         [](const auto& parameter) { return parameter.param.name; });

TEST(Hostile, UndamagedDocumentLoads) {
  TempFolder folder;
  LoadOptions options;
  options.animation = "move";
  const auto path = folder.write("sound.gltf", full().json());
  EXPECT_EQ(refusal(path, options), "was accepted");
}

TEST(Hostile, FilesThatAreNoGltf) {
  TempFolder folder;
  expect_refused(folder.path() / "absent.glb", "not a file that can be opened");
  expect_refused(folder.path(), "not a file that can be opened");
  expect_refused(folder.write("empty.gltf", ""), "too short");
  expect_refused(folder.write("text.gltf", "Dear reader, this is a letter."), "neither a JSON object nor a .glb");
  expect_refused(folder.write("list.gltf", "[1, 2, 3, 4, 5]      "), "neither a JSON object nor a .glb");
  expect_refused(folder.write("cut.gltf", full().json().substr(0, 500)), "not valid JSON");
  expect_refused(folder.write("nan.gltf", R"({"asset":{"version":"2.0"},"nodes":[{"translation":[NaN,0,0]}]})"),
                 "not valid JSON");
  expect_refused(folder.write("huge.gltf", R"({"asset":{"version":"2.0"},"nodes":[{"translation":[1e999,0,0]}]})"),
                 "not valid JSON");
  expect_refused(folder.write("latin.gltf", "{\"asset\":{\"version\":\"2.0\",\"generator\":\"caf\xe9 au lait\"}}"),
                 "not valid JSON");
  expect_refused(folder.write("deep.gltf", "{\"a\":" + std::string(100000, '[') + std::string(100000, ']') + "}"),
                 "nests deeper");
}

TEST(Hostile, BinaryContainers) {
  TempFolder folder;
  const std::string sound = full().glb();
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return std::string(sound).replace(at, bytes.size(), bytes);
  };
  EXPECT_EQ(refusal(folder.write("sound.glb", sound)), "was accepted");
  expect_refused(folder.write("magic.glb", with(0, "glTG")), "neither a JSON object nor a .glb");
  expect_refused(folder.write("version.glb", with(4, GltfBuilder::word(1))), "GLB version 1");
  expect_refused(folder.write("cut.glb", sound.substr(0, sound.size() / 2)), "is cut short");
  expect_refused(folder.write("long.glb", with(8, GltfBuilder::word(0xffffffffu))), "is cut short");
  expect_refused(folder.write("chunk.glb", with(12, GltfBuilder::word(0xfffffff0u))), "beyond the end of the file");
  expect_refused(folder.write("type.glb", with(16, "JSOM")), "does not begin with a JSON chunk");
  expect_refused(folder.write("header.glb", "glTF" + GltfBuilder::word(2) + GltfBuilder::word(12)),
                 "neither a JSON object");
  GltfBuilder no_binary = full();
  const std::string text = no_binary.json("");
  expect_refused(folder.write("bare.gltf", text), "buffer 0 has no data");
}

TEST(Hostile, BufferFileCutShort) {
  TempFolder folder;
  const GltfBuilder builder = full();
  folder.write("data.bin", builder.bytes.substr(0, builder.bytes.size() - 1));
  expect_refused(folder.write("scene.gltf", builder.json("data.bin")), "'data.bin' is cut short");
}

TEST(Hostile, BufferThatIsADevice) {
  TempFolder folder;
  std::filesystem::create_symlink("/dev/zero", folder.path() / "data.bin");
  expect_refused(folder.write("scene.gltf", full().json("data.bin")), "'data.bin' is not there");
}

TEST(Hostile, ImageOfAbsurdSize) {
  TempFolder folder;
  GltfBuilder builder = full();
  builder.root["images"][0] = {
      {"uri", "data:image/png;base64," + GltfBuilder::base64(std::string(kHugePng, sizeof(kHugePng) - 1))}};
  expect_refused(folder.write("scene.gltf", builder.json()), "image '0'");
}

TEST(Hostile, UnknownAnimationAndScene) {
  TempFolder folder;
  const auto path = folder.write("scene.gltf", full().json());
  expect_refused(path, "has no animation 'dance'", {"", "dance", 0.0});
  expect_refused(path, "has no scene '3'", {"3", "", 0.0});
}

// Node chains may be deep: nothing recurses over them.
TEST(Hostile, HundredThousandNestedNodes) {
  TempFolder folder;
  GltfBuilder builder = GltfBuilder::triangle();
  constexpr int kDepth = 100000;
  for (int i = 1; i < kDepth; ++i) builder.add("nodes", {{"children", {i == 1 ? 0 : i - 1}}});
  const Scene scene = load_gltf(folder.write("deep.gltf", builder.json()));
  EXPECT_EQ(scene.instances.size(), 1u);
}

// Random damage: whatever it does, the file loads or is refused by an Error.
TEST(Hostile, RandomDamage) {
  TempFolder folder;
  const std::string sound = full().glb();
  std::mt19937 random(1);
  int accepted = 0, refused = 0;
  LoadOptions options;
  options.animation = "0";
  options.at = 0.5;
  for (int trial = 0; trial < 1500; ++trial) {
    std::string damaged = sound;
    const int edits = 1 + static_cast<int>(random() % 3);
    for (int i = 0; i < edits; ++i) {
      char& byte = damaged[random() % damaged.size()];
      byte = random() % 2 ? static_cast<char>(random()) : static_cast<char>('0' + random() % 10);
    }
    const auto path = folder.write("damaged.glb", damaged);
    const std::string message = refusal(path, options);
    EXPECT_FALSE(message.starts_with("not an Error")) << message;
    (message == "was accepted" ? accepted : refused) += 1;
  }
  // Both must happen, or the damage is too weak or too strong to show anything.
  EXPECT_GT(accepted, 100);
  EXPECT_GT(refused, 100);
}

} // namespace
} // namespace wavepath
