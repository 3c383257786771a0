// Scenes of pbrt-v4 and Mitsuba 3 become glTF: places, cameras, materials, lights and textures by value, meshes of
// every kind of file, what is lost by name, and broken files, which are refused in one line.
#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>
#include <zlib.h>

#include "host/base/error.h"
#include "host/convert/convert.h"
#include "host/convert/materials.h"
#include "host/convert/mesh_files.h"
#include "host/convert/shapes.h"
#include "host/convert/spectrum.h"
#include "host/convert/textures.h"
#include "host/picture/files/picture_io.h"
#include "host/scene/gltf/foreign.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/spectrum.h"
#include "tests/gltf_builder.h"
#include "tests/volume_files.h"

namespace wavepath {
namespace {

using convert::Converted;
using test::TempFolder;

struct Result {
  Converted converted;
  Scene scene;
};

// The scene that the text of a file becomes.
Result convert_text(const TempFolder& folder, const std::string& name, const std::string& text) {
  const std::string output = (folder.path() / "out.glb").string();
  Result result;
  result.converted = convert::convert_scene(folder.write(name, text).string(), output);
  result.scene = load_gltf(output);
  return result;
}
Result of_pbrt(const TempFolder& folder, const std::string& text) { return convert_text(folder, "scene.pbrt", text); }
Result of_mitsuba(const TempFolder& folder, const std::string& text) {
  return convert_text(folder, "scene.xml", "<scene version='3.0.0'>" + text + "</scene>");
}

const std::string kTriangle = "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]\n";

std::size_t lost(const Converted& converted, const std::string& part) {
  std::size_t count = 0;
  for (const auto& [text, times] : converted.losses.counts())
    if (text.find(part) != std::string::npos) count += times;
  return count;
}

// Where a point of the world of the source is for the camera: x to the right, y up, -z ahead.
glm::dvec3 seen(const Scene& scene, const glm::dvec3& world) {
  return glm::dvec3(glm::inverse(scene.cameras.at(0).world_from_camera) * glm::dvec4(world, 1.0));
}
glm::dvec3 position(const Scene& scene, std::size_t instance, std::size_t vertex) {
  const Instance& placed = scene.instances.at(instance);
  return glm::dvec3(placed.world_from_object * glm::dvec4(scene.meshes[placed.mesh].positions.at(vertex), 1.0));
}

void expect_near(const glm::dvec3& a, const glm::dvec3& b, double tolerance = 1e-5) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

// --- cameras: a picture must not be mirrored ---

TEST(ConvertPbrt, CameraSeesPlusXOnTheRight) {
  const TempFolder folder;
  const Result result = of_pbrt(folder,
                                "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
                                "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100\n"
                                "WorldBegin\nTranslate 1 0.5 2\n" +
                                    kTriangle);
  expect_near(seen(result.scene, position(result.scene, 0, 0)), {1.0, 0.5, -7.0});
  EXPECT_NEAR(result.scene.cameras[0].yfov, glm::radians(40.0), 1e-9); // of the shorter side
  EXPECT_NE(result.converted.command.find(" --size 200x100 --env black"), std::string::npos)
      << result.converted.command;
}

TEST(ConvertPbrt, FieldOfViewOfATallPictureIsThatOfItsWidth) {
  const TempFolder folder;
  const Result result = of_pbrt(folder,
                                "Camera \"perspective\" \"float fov\" 40\n"
                                "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 300\n"
                                "WorldBegin\n" +
                                    kTriangle);
  EXPECT_NEAR(std::tan(0.5 * result.scene.cameras[0].yfov), 3.0 * std::tan(glm::radians(20.0)), 1e-9);
}

TEST(ConvertPbrt, AMirroredCameraMirrorsAsInPbrt) {
  const TempFolder folder;
  // "Scale -1 1 1", as exporters of right-handed programs write it: +X is on the left.
  const Result result = of_pbrt(folder,
                                "Scale -1 1 1\nLookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\"\nWorldBegin\n"
                                "Translate 1 0 0\n" +
                                    kTriangle);
  EXPECT_NEAR(seen(result.scene, position(result.scene, 0, 0)).x, -1.0, 1e-6);
}

TEST(ConvertMitsuba, CameraSeesPlusXOnTheLeft) {
  const TempFolder folder;
  const Result result = of_mitsuba(
      folder,
      "<sensor type='perspective'><float name='fov' value='40'/><transform name='to_world'>"
      "<lookat origin='0,0,-5' target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'>"
      "<integer name='width' value='200'/><integer name='height' value='100'/></film></sensor>"
      "<shape type='rectangle'><transform name='to_world'><translate x='1' y='0.5' z='2'/></transform></shape>");
  const glm::dvec3 middle = 0.5 * (position(result.scene, 0, 0) + position(result.scene, 0, 3));
  expect_near(seen(result.scene, middle), {-1.0, 0.5, -7.0});
  EXPECT_NEAR(std::tan(0.5 * result.scene.cameras[0].yfov), 0.5 * std::tan(glm::radians(20.0)), 1e-9); // fov_axis x
}

TEST(ConvertMitsuba, EveryAxisOfTheFieldOfView) {
  const double t = std::tan(glm::radians(20.0));
  const std::pair<const char*, double> cases[] = {
      {"x", t / 2.0}, {"y", t}, {"smaller", t}, {"larger", t / 2.0}, {"diagonal", t / std::sqrt(5.0)}};
  for (const auto& [axis, expected] : cases) {
    const TempFolder folder;
    const Result result = of_mitsuba(
        folder,
        std::string("<default name='axis' value='") + axis +
            "'/><sensor type='perspective'><string name='fov_axis' value='$axis'/><float name='fov' value='40'/>"
            "<film type='hdrfilm'><integer name='width' value='200'/><integer name='height' value='100'/></film>"
            "</sensor><shape type='cube'/>");
    EXPECT_NEAR(std::tan(0.5 * result.scene.cameras[0].yfov), expected, 1e-9) << axis;
  }
}

TEST(ConvertMitsuba, WithoutFieldOfViewItIsALensOf50mm) {
  const TempFolder folder;
  const Result result = of_mitsuba(folder,
                                   "<sensor type='perspective'><film type='hdrfilm'><integer name='width' value='48'/>"
                                   "<integer name='height' value='48'/></film></sensor><shape type='cube'/>");
  EXPECT_NEAR(std::tan(0.5 * result.scene.cameras[0].yfov), 0.5 * std::hypot(36.0, 24.0) / 50.0 / std::sqrt(2.0), 1e-9);
}

// --- transforms ---

TEST(ConvertPbrt, TransformsStack) {
  const TempFolder folder;
  const Result result = of_pbrt(
      folder, "WorldBegin\nTranslate 1 0 0\nAttributeBegin\nRotate 90 0 0 1\nScale 2 2 2\n" + kTriangle +
                  "AttributeEnd\nConcatTransform [1 0 0 0 0 1 0 0 0 0 1 0 0 0 7 1]\n" + kTriangle +
                  "ObjectBegin \"o\"\nIdentity\nTranslate 0 1 0\n" + kTriangle + "ObjectEnd\nObjectInstance \"o\"\n");
  expect_near(position(result.scene, 0, 1), {1.0, 2.0, 0.0}); // x turns to y
  expect_near(position(result.scene, 1, 0), {1.0, 0.0, 7.0});
  expect_near(position(result.scene, 2, 0), {1.0, 1.0, 7.0}); // the instance's matrix, then the shape's own
  EXPECT_EQ(result.converted.instances, 1u);
}

TEST(ConvertMitsuba, TransformsApplyInOrder) {
  const TempFolder folder;
  const Result result =
      of_mitsuba(folder,
                 "<shape type='sphere'><transform name='to_world'><scale value='2'/><rotate z='1' angle='90'/>"
                 "<translate x='1'/></transform><point name='center' x='3' y='0' z='0'/></shape>");
  glm::dvec3 lo(1e9), hi(-1e9);
  for (std::size_t i = 0; i < result.scene.meshes[0].positions.size(); ++i)
    lo = glm::min(lo, position(result.scene, 0, i)), hi = glm::max(hi, position(result.scene, 0, i));
  expect_near(0.5 * (lo + hi), {1.0, 6.0, 0.0}, 1e-2);
}

TEST(ConvertPbrt, MotionKeepsTheStart) {
  const TempFolder folder;
  const Result result =
      of_pbrt(folder, "WorldBegin\nActiveTransform EndTime\nTranslate 5 0 0\nActiveTransform All\n" + kTriangle);
  expect_near(position(result.scene, 0, 0), glm::dvec3(0.0));
  EXPECT_EQ(lost(result.converted, "motion of a transform"), 1u);
}

// --- materials ---

TEST(ConvertPbrt, Materials) {
  const TempFolder folder;
  const Result result = of_pbrt(
      folder,
      "WorldBegin\nMaterial \"diffuse\" \"rgb reflectance\" [.1 .2 .3]\n" + kTriangle +
          "Material \"conductor\" \"float roughness\" .0625 \"rgb eta\" [1 1 1] \"rgb k\" [2 2 2]\n" + kTriangle +
          "Material \"conductor\" \"float uroughness\" .25 \"float vroughness\" .04 \"bool remaproughness\" false\n" +
          kTriangle + "Material \"dielectric\" \"float eta\" 1.33\n" + kTriangle + "Material \"thindielectric\"\n" +
          kTriangle + "Material \"coateddiffuse\" \"rgb reflectance\" [.5 .5 .5]\n" + kTriangle +
          "Material \"diffusetransmission\" \"rgb reflectance\" [.3 .3 .3] \"rgb transmittance\" [.1 .1 .1]\n" +
          kTriangle + "Material \"coatedconductor\" \"float interface.roughness\" .0625\n" + kTriangle);
  const auto& materials = result.scene.materials;
  ASSERT_EQ(materials.size(), 8u);
  expect_near(glm::dvec3(materials[0].base_color), {0.1, 0.2, 0.3});
  EXPECT_EQ(materials[0].specular, 0.0f); // no specular layer
  EXPECT_TRUE(materials[0].double_sided);
  expect_near(glm::dvec3(materials[1].base_color), glm::dvec3(4.0 / 8.0)); // k^2 / (4 + k^2)
  EXPECT_EQ(materials[1].metallic, 1.0f);
  EXPECT_NEAR(materials[1].roughness, 0.5, 1e-6); // alpha is sqrt(1/16), glTF's roughness its root
  EXPECT_NEAR(materials[2].roughness, 0.2, 1e-6);
  EXPECT_NEAR(materials[2].anisotropy, std::sqrt((0.25 - 0.04) / 0.96), 1e-6);
  expect_near(glm::dvec3(materials[2].base_color), {0.955, 0.638, 0.538}, 1e-3); // copper
  EXPECT_NEAR(materials[3].ior, 1.33, 1e-6);
  EXPECT_EQ(materials[3].transmission, 1.0f);
  EXPECT_TRUE(materials[3].volume);
  EXPECT_EQ(materials[3].roughness, 0.0f);
  EXPECT_FALSE(materials[4].volume);
  const double inside = 0.5963; // of a smooth surface of 1.5, seen from within
  EXPECT_NEAR(materials[5].base_color.r, 0.5 * (1.0 - inside) / (1.0 - 0.5 * inside), 1e-3);
  EXPECT_NEAR(materials[6].diffuse_transmission, 0.25, 1e-6);
  EXPECT_NEAR(materials[6].base_color.r * 0.75, 0.3, 1e-6);
  EXPECT_NEAR(materials[6].diffuse_transmission_color.r * 0.25, 0.1, 1e-6);
  EXPECT_EQ(materials[7].coat, 1.0f);
  EXPECT_NEAR(materials[7].coat_roughness, 0.5, 1e-6);
}

TEST(ConvertMitsuba, Materials) {
  const TempFolder folder;
  const auto shape = [](const std::string& bsdf) { return "<shape type='cube'>" + bsdf + "</shape>"; };
  const Result result = of_mitsuba(
      folder,
      "<bsdf type='twosided' id='a'><bsdf type='diffuse'><rgb name='reflectance' value='.1,.2,.3'/></bsdf></bsdf>" +
          shape("<ref id='a'/>") +
          shape("<bsdf type='roughconductor'><string name='material' value='Au'/><float name='alpha' value='.25'/>"
                "<string name='distribution' value='ggx'/></bsdf>") +
          shape(
              "<bsdf type='dielectric'><float name='int_ior' value='1.5'/><float name='ext_ior' value='1.2'/></bsdf>") +
          shape("<bsdf type='plastic'><float name='diffuse_reflectance' value='.4'/></bsdf>") +
          shape("<bsdf type='plastic'><float name='diffuse_reflectance' value='.4'/><float name='int_ior' value='1.5'/>"
                "<boolean name='nonlinear' value='true'/></bsdf>") +
          shape("<bsdf type='principled'><rgb name='base_color' value='.2 .4 .6'/><float name='roughness' value='.3'/>"
                "<float name='metallic' value='.7'/></bsdf>") +
          shape("<bsdf type='mask'><float name='opacity' value='.25'/><bsdf type='diffuse'/></bsdf>") +
          shape("<bsdf type='blendbsdf'><float name='weight' value='.25'/><bsdf type='diffuse'><rgb name='reflectance' "
                "value='1 1 1'/></bsdf><bsdf type='diffuse'><rgb name='reflectance' value='0 0 0'/></bsdf></bsdf>"));
  const auto& materials = result.scene.materials;
  ASSERT_EQ(materials.size(), 8u);
  expect_near(glm::dvec3(materials[0].base_color), {0.1, 0.2, 0.3});
  expect_near(glm::dvec3(materials[1].base_color), {1.0, 0.783, 0.343}, 1e-3);
  EXPECT_NEAR(materials[1].roughness, 0.5, 1e-6);
  EXPECT_NEAR(materials[2].ior, 1.25, 1e-6);
  EXPECT_NEAR(materials[3].base_color.r, 0.4, 1e-6);
  EXPECT_NEAR(materials[3].ior, 1.49 / 1.000277, 1e-5);
  EXPECT_NEAR(materials[4].base_color.r, 0.4 * (1.0 - 0.5963) / (1.0 - 0.4 * 0.5963), 1e-3);
  EXPECT_NEAR(materials[5].metallic, 0.7, 1e-6);
  EXPECT_NEAR(materials[5].roughness, 0.3, 1e-6);
  EXPECT_EQ(materials[6].alpha_mode, AlphaMode::blend);
  EXPECT_NEAR(materials[6].base_color.a, 0.25, 1e-6);
  EXPECT_NEAR(materials[7].base_color.r, 0.75, 1e-6);
  EXPECT_EQ(lost(result.converted, "mixture of two materials"), 1u);
}

TEST(Convert, MediaInBodiesAbsorbAndScatter) {
  const TempFolder folder;
  const Result pbrt =
      of_pbrt(folder,
              "WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] "
              "\"rgb sigma_s\" [0 1 3] \"float scale\" 2 \"float g\" .5\n"
              "MediumInterface \"m\" \"\"\nMaterial \"dielectric\"\n" +
                  kTriangle);
  expect_near(glm::dvec3(pbrt.scene.materials[0].attenuation), {2.0, 6.0, 12.0}, 1e-4);
  expect_near(glm::dvec3(pbrt.scene.materials[0].scattering), {0.0, 2.0, 6.0}, 1e-3);
  EXPECT_NEAR(pbrt.scene.materials[0].scattering_anisotropy, 0.5, 1e-6);
  const Result mitsuba = of_mitsuba(
      folder,
      "<shape type='cube'><bsdf type='dielectric'/><medium name='interior' type='homogeneous'><rgb name='sigma_t' "
      "value='1 2 4'/><float name='albedo' value='.25'/><float name='scale' value='2'/></medium></shape>");
  expect_near(glm::dvec3(mitsuba.scene.materials[0].attenuation), {2.0, 4.0, 8.0}, 1e-4);
  expect_near(glm::dvec3(mitsuba.scene.materials[0].scattering), {0.5, 1.0, 2.0}, 1e-3);
}

// A sphere that is the boundary of a medium.
std::string boundary(const std::string& medium, double radius) {
  return "AttributeBegin\nMaterial \"interface\"\nMediumInterface \"" + medium +
         "\" \"\"\nShape \"sphere\" \"float radius\" " + std::to_string(radius) + "\nAttributeEnd\n";
}

TEST(ConvertPbrt, MediumOfNanovdb) {
  const TempFolder folder;
  test::GridSpec density, temperature;
  density.voxel = temperature.voxel = 0.25, temperature.name = "temperature";
  const test::CoordBBox box(test::Coord(-4), test::Coord(3));
  const std::string source = (folder.path() / "smoke.nvdb").string();
  test::write_grids(source, nanovdb::io::Codec::ZIP,
                    test::build_grid([](const test::Coord& p) { return static_cast<float>(5 + p[0]); }, box, density),
                    test::build_grid([](const test::Coord&) { return 1200.0f; }, box, temperature));
  const auto text = [](double radius) {
    return "Camera \"perspective\"\nWorldBegin\nAttributeBegin\nTranslate 0 1 0\nScale 2 2 2\nMakeNamedMedium "
           "\"smoke\" \"string type\" "
           "\"nanovdb\" \"string filename\" \"smoke.nvdb\" \"spectrum sigma_a\" [200 0.5 900 0.5] \"rgb sigma_s\" [1 2 "
           "3] "
           "\"float scale\" 2 \"float g\" 0.5 \"float Lescale\" 3 \"float temperaturescale\" 4 \"float "
           "temperatureoffset\" 100\n" +
           boundary("smoke", radius) + "AttributeEnd\n" + kTriangle;
  };
  const Result result = of_pbrt(folder, text(2.0));
  EXPECT_EQ(lost(result.converted, "sphere as triangles"), 1u);
  EXPECT_EQ(result.converted.losses.counts().size(), 1u);
  EXPECT_EQ(result.converted.files.back(), (folder.path() / "out.nvdb").string());
  EXPECT_EQ(result.scene.instances.size(), 1u) << "the boundary is no surface";
  ASSERT_TRUE(result.scene.volume);
  const Volume& volume = *result.scene.volume;
  expect_near(glm::dvec3(volume.scattering), {2.0, 4.0, 6.0});
  expect_near(glm::dvec3(volume.absorption), glm::dvec3(1.0), 1e-3);
  EXPECT_EQ(volume.anisotropy, 0.5f);
  EXPECT_EQ(volume.emission, 3.0f);
  EXPECT_EQ(volume.temperature_scale, 4.0f);
  EXPECT_EQ(volume.temperature_offset, 100.0f);
  EXPECT_TRUE(volume.shines());
  // Voxel 0 of the file lies at 0, 1, 0; the world is mirrored along z.
  const glm::dmat4 world_from_index = volume.world_from_grid * volume.grids->density.grid_from_index;
  expect_near(glm::dvec3(world_from_index * glm::dvec4(0, 0, 0, 1)), {0.0, 1.0, 0.0});
  expect_near(glm::dvec3(world_from_index * glm::dvec4(1, 2, 3, 1)), {0.5, 2.0, -1.5});
  EXPECT_EQ(lost(of_pbrt(folder, text(1.0)).converted, "boundary within a medium of voxels"), 1u);
}

TEST(ConvertPbrt, MediumOfAUniformGrid) {
  const TempFolder folder;
  const Result result =
      of_pbrt(folder,
              "WorldBegin\nMakeNamedMedium \"fog\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"integer ny\" 1 "
              "\"integer nz\" 3 \"float density\" [1 2 3 4 5 6] \"point3 p0\" [-1 -1 -1] \"point3 p1\" [1 1 1] \"rgb "
              "sigma_a\" [0 0 0] \"rgb sigma_s\" [1 1 1]\n" +
                  boundary("fog", 3.0) + kTriangle);
  ASSERT_TRUE(result.scene.volume);
  const VoxelGrid& density = result.scene.volume->grids->density;
  ASSERT_EQ(density.brick_counts, glm::ivec3(1));
  for (std::size_t z = 0; z < 3; ++z)
    for (std::size_t x = 0; x < 2; ++x)
      EXPECT_EQ(density.voxels.at(64 * x + z), static_cast<float>(1 + x + 2 * z)); // x is the slowest
  const glm::dmat4 world_from_index = result.scene.volume->world_from_grid * density.grid_from_index;
  expect_near(glm::dvec3(world_from_index * glm::dvec4(1, 0, 2, 1)), {0.5, 0.0, 2.0 / 3.0});
  EXPECT_EQ(lost(result.converted, "boundary"), 0u);
}

TEST(ConvertPbrt, MediumOfAnRgbGridOfOneColour) {
  const TempFolder folder;
  const auto text = [](const char* last) {
    return std::string(
               "WorldBegin\nMakeNamedMedium \"fog\" \"string type\" \"rgbgrid\" \"integer nx\" 2 \"float scale\" 3 "
               "\"rgb sigma_a\" [1 0 0 2 0 0] \"rgb sigma_s\" [0 1 2 ") +
           last + "]\n" + boundary("fog", 3.0) + kTriangle;
  };
  const Result result = of_pbrt(folder, text("0 2 4"));
  ASSERT_TRUE(result.scene.volume);
  expect_near(glm::dvec3(result.scene.volume->absorption), {6.0, 0.0, 0.0});
  expect_near(glm::dvec3(result.scene.volume->scattering), {0.0, 6.0, 12.0});
  const VoxelGrid& density = result.scene.volume->grids->density;
  EXPECT_EQ(density.voxels.at(0), 0.5f);
  EXPECT_EQ(density.voxels.at(64), 1.0f);
  const Result other = of_pbrt(folder, text("0 2 3"));
  EXPECT_FALSE(other.scene.volume);
  EXPECT_EQ(lost(other.converted, "medium 'rgbgrid of other colours"), 1u);
}

TEST(ConvertMitsuba, MediumOfAGrid) {
  const TempFolder folder;
  std::string grid = "VOL\x03";
  for (const std::uint32_t word : {1u, 2u, 1u, 3u, 1u}) grid += test::GltfBuilder::word(word);
  for (const float number : {0.f, 0.f, 0.f, 1.f, 1.f, 1.f, 1.f, 2.f, 3.f, 4.f, 5.f, 6.f})
    grid.append(reinterpret_cast<const char*>(&number), sizeof(number));
  folder.write("fog.vol", grid);
  const std::string medium =
      "<medium name='interior' type='heterogeneous'><volume name='sigma_t' type='gridvolume'><string name='filename' "
      "value='fog.vol'/><transform name='to_world'><translate x='-.5' y='-.5' z='-.5'/><scale value='2'/></transform>"
      "</volume><rgb name='albedo' value='1 .5 0'/><float name='scale' value='4'/><phase type='hg'><float name='g' "
      "value='.5'/></phase></medium>";
  const Result result = of_mitsuba(folder, "<shape type='cube'><bsdf type='null'/>" + medium + "</shape>");
  ASSERT_TRUE(result.scene.volume);
  EXPECT_TRUE(result.scene.instances.empty());
  EXPECT_TRUE(result.converted.losses.empty());
  const Volume& volume = *result.scene.volume;
  expect_near(glm::dvec3(volume.scattering), {4.0, 2.0, 0.0});
  expect_near(glm::dvec3(volume.absorption), {0.0, 2.0, 4.0});
  EXPECT_EQ(volume.anisotropy, 0.5f);
  const VoxelGrid& density = volume.grids->density;
  EXPECT_EQ(density.voxels.at(64 + 2), 6.0f); // the last one, at x 1 and z 2
  const glm::dmat4 world_from_index = volume.world_from_grid * density.grid_from_index;
  expect_near(glm::dvec3(world_from_index * glm::dvec4(1, 0, 2, 1)), {0.5, 0.0, 2.0 / 3.0});
  folder.write("fog.vol", grid.substr(0, 60));
  EXPECT_THROW(of_mitsuba(folder, "<shape type='cube'><bsdf type='null'/>" + medium + "</shape>"), Error);
}

TEST(ConvertPbrt, MediaOfVoxelsThatAreLost) {
  const TempFolder folder;
  const auto fog = [](const std::string& name, const std::string& type) {
    return "MakeNamedMedium \"" + name + "\" \"string type\" \"" + type + "\" \"float density\" [1]\n";
  };
  const Result two = of_pbrt(folder, "WorldBegin\n" + fog("a", "uniformgrid") + fog("b", "uniformgrid") +
                                         boundary("a", 3.0) + boundary("b", 3.0) + boundary("a", 4.0) + kTriangle);
  EXPECT_EQ(lost(two.converted, "medium of voxels besides the first one"), 1u);
  const Result cloud = of_pbrt(folder, "WorldBegin\n" + fog("a", "cloud") + boundary("a", 3.0) + kTriangle);
  EXPECT_FALSE(cloud.scene.volume);
  EXPECT_EQ(lost(cloud.converted, "medium 'cloud'"), 1u);
  EXPECT_EQ(lost(cloud.converted, "medium in the air"), 1u);
  EXPECT_THROW(of_pbrt(folder,
                       "WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"nanovdb\" \"string filename\" "
                       "\"absent.nvdb\"\n" +
                           boundary("m", 1.0)),
               Error);
  EXPECT_THROW(of_pbrt(folder,
                       "WorldBegin\nMakeNamedMedium \"m\" \"string type\" \"uniformgrid\" \"integer nx\" 2 "
                       "\"float density\" [1]\n"),
               Error);
}

// --- lights ---

TEST(ConvertPbrt, Lights) {
  const TempFolder folder;
  const Result result =
      of_pbrt(folder,
              "WorldBegin\nLightSource \"point\" \"rgb I\" [1 2 4] \"float scale\" 3 \"point3 from\" [1 2 3]\n"
              "LightSource \"point\" \"float power\" 12.566370614359172\n"
              "LightSource \"spot\" \"blackbody I\" 6500 \"float coneangle\" 40 \"float conedeltaangle\" 10 \"point3 "
              "to\" [0 -1 0]\n"
              "LightSource \"distant\" \"rgb L\" [2 2 2] \"point3 from\" [0 5 0] \"point3 to\" [0 0 0]\n"
              "LightSource \"infinite\" \"rgb L\" [.5 .25 .125] \"float scale\" 2\n"
              "AttributeBegin\nAreaLightSource \"diffuse\" \"rgb L\" [2 4 8]\n" +
                  kTriangle + "AttributeEnd\nAreaLightSource \"diffuse\" \"float power\" 10 \"bool twosided\" true\n" +
                  kTriangle);
  const auto& lights = result.scene.lights;
  ASSERT_EQ(lights.size(), 4u);
  expect_near(glm::dvec3(lights[0].intensity), {3.0, 6.0, 12.0});
  expect_near(lights[0].position, {1.0, 2.0, 3.0});
  expect_near(glm::dvec3(lights[1].intensity), glm::dvec3(1.0));
  EXPECT_NEAR(lights[2].outer_cone, glm::radians(40.0), 1e-6);
  EXPECT_NEAR(lights[2].inner_cone, glm::radians(30.0), 1e-6);
  expect_near(lights[2].direction, {0.0, -1.0, 0.0});
  EXPECT_NEAR(convert::luminance(glm::dvec3(lights[2].intensity)), 1.0, 1e-5);
  EXPECT_EQ(lights[3].kind, LightKind::directional);
  expect_near(lights[3].direction, {0.0, -1.0, 0.0});
  EXPECT_NE(result.converted.command.find(" --env 1,0.5,0.25 "), std::string::npos) << result.converted.command;
  expect_near(glm::dvec3(result.scene.materials[0].emission), {2.0, 4.0, 8.0});
  EXPECT_FALSE(result.scene.materials[0].double_sided); // it shines from one side
  EXPECT_NEAR(result.scene.materials[1].emission.g, 10.0 / (0.5 * 2.0 * 3.14159265), 1e-4);
  EXPECT_TRUE(result.scene.materials[1].double_sided);
}

// The side that shines: the winding, turned by ReverseOrientation, and by normals where there are some.
TEST(ConvertPbrt, AreaLightsShineFromTheSideThatPbrtMeans) {
  const std::string light = "AreaLightSource \"diffuse\"\n";
  const std::string normals =
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -1] \"integer indices\" "
      "[0 1 2]\n";
  const std::pair<std::string, double> cases[] = {{kTriangle, 1.0},
                                                  {"ReverseOrientation\n" + kTriangle, -1.0},
                                                  {"Scale 1 1 -1\n" + kTriangle, -1.0}, // the normal moves along
                                                  {normals, -1.0},
                                                  {"ReverseOrientation\n" + normals, 1.0}};
  for (const auto& [shape, z] : cases) {
    const TempFolder folder;
    const Scene scene = of_pbrt(folder, "WorldBegin\n" + light + shape).scene;
    const Mesh& mesh = scene.meshes[0];
    const glm::dmat4& matrix = scene.instances[0].world_from_object;
    const auto at = [&](std::size_t i) {
      return glm::dvec3(matrix * glm::dvec4(mesh.positions[mesh.indices[i]], 1.0));
    };
    const double turn = glm::determinant(glm::dmat3(matrix)) < 0.0 ? -1.0 : 1.0; // as glTF has it
    EXPECT_GT(turn * glm::cross(at(1) - at(0), at(2) - at(0)).z * z, 0.0) << shape;
  }
}

TEST(ConvertMitsuba, Lights) {
  const TempFolder folder;
  const Result result = of_mitsuba(
      folder,
      "<emitter type='point'><rgb name='intensity' value='1 2 4'/><point name='position' x='1' y='2' z='3'/></emitter>"
      "<emitter type='spot'><float name='cutoff_angle' value='40'/><transform name='to_world'>"
      "<lookat origin='0,1,0' target='1,1,0' up='0,1,0'/></transform></emitter>"
      "<emitter type='directional'><vector name='direction' x='0' y='-2' z='0'/></emitter>"
      "<emitter type='constant'><rgb name='radiance' value='.5'/></emitter>"
      "<shape type='rectangle'><emitter type='area'><spectrum name='radiance' value='3'/></emitter></shape>");
  const auto& lights = result.scene.lights;
  ASSERT_EQ(lights.size(), 3u);
  expect_near(glm::dvec3(lights[0].intensity), {1.0, 2.0, 4.0});
  expect_near(lights[0].position, {1.0, 2.0, 3.0});
  EXPECT_NEAR(lights[1].inner_cone, glm::radians(30.0), 1e-6);
  expect_near(lights[1].direction, {1.0, 0.0, 0.0});
  expect_near(lights[2].direction, {0.0, -1.0, 0.0});
  expect_near(glm::dvec3(result.scene.materials[0].emission), glm::dvec3(3.0));
  EXPECT_NE(result.converted.command.find(" --env 0.5,0.5,0.5"), std::string::npos);
}

TEST(Convert, SpectraAsColours) {
  Spectrum one;
  one.fill(1.0);
  expect_near(convert::reflected_color(one), glm::dvec3(1.0), 1e-9);
  EXPECT_NEAR(convert::luminance(light_color(one)), 1.0, 1e-3);
  expect_near(light_color(one), {1.205, 0.948, 0.909}, 5e-3); // equal energy in Rec. 709
  // 6504 K is nearly white, 2856 K is orange.
  const glm::dvec3 warm = convert::unit_luminance(light_color(black_body(2856.0)));
  expect_near(convert::unit_luminance(light_color(black_body(6504.0))), {1.04, 0.98, 1.02}, 0.05);
  EXPECT_GT(warm.r, 1.8 * warm.g);
  EXPECT_LT(warm.b, 0.3 * warm.g);
  // 2 h c^2 / lambda^5 / (e^x - 1) at 5000 K and 580 nm.
  EXPECT_NEAR(black_body(5000.0)[20], 1.2816e4, 1.0e2);
  expect_near(convert::named_illuminant("stdillum-D65").value(), glm::dvec3(1.0));
  EXPECT_NEAR(convert::internal_diffuse_reflectance(1.5), 0.5963, 1e-4);
}

// --- environments ---

void write_map(const std::string& path, std::uint32_t width, std::uint32_t height,
               const std::function<float(std::uint32_t, std::uint32_t)>& value) {
  Picture picture{width, height, {}};
  for (const char* name : {"R", "G", "B"}) {
    Channel channel{name, {}};
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) channel.values.push_back(value(x, y));
    picture.channels.push_back(std::move(channel));
  }
  write_picture(path, picture, {}, {});
}

// The radiance of a map of --env in a direction.
float radiance(const Picture& map, const glm::dvec3& direction) {
  const double pi = 3.141592653589793, u = std::atan2(direction.z, direction.x) / (2.0 * pi) + 0.5;
  const double v = std::acos(glm::normalize(direction).y) / pi;
  const auto x = std::min(static_cast<std::uint32_t>(u * map.width), map.width - 1);
  const auto y = std::min(static_cast<std::uint32_t>(v * map.height), map.height - 1);
  return map.channels[0].values[std::size_t{y} * map.width + x];
}

TEST(ConvertPbrt, EnvironmentsOfEqualAreaAreTurnedAndMirrored) {
  const TempFolder folder;
  // Bright towards +X and +Z of the light: the corner of the diamond in the middle that the directions (1, 0, 1) fall
  // on.
  write_map((folder.path() / "map.exr").string(), 64, 64,
            [](std::uint32_t x, std::uint32_t y) { return x > 46 && x < 58 && y > 26 && y < 38 ? 10.0f : 1.0f; });
  const std::string light = "LightSource \"infinite\" \"string filename\" \"map.exr\" \"float scale\" 2\n" + kTriangle;
  of_pbrt(folder, "WorldBegin\n" + light);
  Picture map = read_picture((folder.path() / "out.env.exr").string());
  EXPECT_NEAR(radiance(map, {1, 0, 0.6}), 20.0f, 0.1f);
  for (const glm::dvec3& d : {glm::dvec3(-1, 0, 1), {1, 0, -1}, {0, 1, 0.01}, {0, -1, 0.01}, {0, 0.3, 1}})
    EXPECT_NEAR(radiance(map, d), 2.0f, 0.1f) << d.x << d.y << d.z;
  of_pbrt(folder, "Camera \"perspective\"\nWorldBegin\nRotate 90 0 0 1\n" + light); // mirrored, and x turns to y
  map = read_picture((folder.path() / "out.env.exr").string());
  EXPECT_NEAR(radiance(map, {0, 1, -0.6}), 20.0f, 0.1f);
  EXPECT_NEAR(radiance(map, {0, 1, 0.6}), 2.0f, 0.1f);
}

TEST(ConvertMitsuba, EnvironmentsAreTurned) {
  const TempFolder folder;
  // The middle column looks along +Z, the first along -Z; the quarter along +X.
  write_map((folder.path() / "map.exr").string(), 64, 32,
            [](std::uint32_t x, std::uint32_t y) { return x > 12 && x < 20 && y > 12 && y < 20 ? 10.0f : 1.0f; });
  of_mitsuba(folder, "<emitter type='envmap'><string name='filename' value='map.exr'/></emitter><shape type='cube'/>");
  const Picture map = read_picture((folder.path() / "out.env.exr").string());
  EXPECT_NEAR(radiance(map, {1, 0, 0}), 10.0f, 0.1f);
  for (const glm::dvec3& d : {glm::dvec3(-1, 0, 0.01), {0, 0, 1}, {0, 0, -1}})
    EXPECT_NEAR(radiance(map, d), 1.0f, 0.1f);
}

// --- textures ---

TEST(Convert, TexturesKeepTheirPlace) {
  const TempFolder folder;
  write_map((folder.path() / "map.png").string(), 4, 4,
            [](std::uint32_t x, std::uint32_t y) { return x < 2 && y < 2 ? 1.0f : 0.0f; });
  const Result result =
      of_pbrt(folder,
              "WorldBegin\nTexture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"map.png\" \"float uscale\" 2 "
              "\"float vscale\" 3 "
              "\"float udelta\" .25 \"float vdelta\" .5\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\n"
              "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"point2 uv\" [.1 .2 .5 .2 .1 .7] \"integer "
              "indices\" [0 1 2]\n");
  const TextureSlot& slot = result.scene.materials[0].base_color_texture;
  const glm::vec2 uv = result.scene.meshes[0].uvs[0][0]; // (.1, .2) of pbrt
  const glm::vec2 at = slot.uv_matrix * uv + slot.uv_offset;
  EXPECT_NEAR(at.x, 2.0 * 0.1 + 0.25, 1e-6);
  EXPECT_NEAR(at.y, 1.0 - (3.0 * 0.2 + 0.5), 1e-6); // rows of glTF's image grow downwards
}

TEST(Convert, RoughnessOfATextureIsThatOfGltf) {
  const TempFolder folder;
  write_map((folder.path() / "map.png").string(), 4, 4, [](std::uint32_t, std::uint32_t) { return 0.5f; });
  const std::string texture = "WorldBegin\nTexture \"t\" \"float\" \"imagemap\" \"string filename\" \"map.png\" ";
  const std::string use = "\nMaterial \"conductor\" \"texture roughness\" \"t\"\n" + kTriangle;
  const auto green = [&](const Result& result) {
    EXPECT_TRUE(result.converted.losses.empty());
    const std::uint32_t image = result.scene.materials[0].metallic_roughness_texture.image;
    return result.scene.images.at(image).bytes.at(1) / 255.0;
  };
  const double stored = read_picture((folder.path() / "map.png").string()).channels[0].values[0]; // linear
  EXPECT_NEAR(green(of_pbrt(folder, texture + use)), std::pow(stored, 0.25), 5e-3);
  const double byte = stored <= 0.0031308 ? stored * 12.92 : 1.055 * std::pow(stored, 1.0 / 2.4) - 0.055;
  EXPECT_NEAR(green(of_pbrt(folder, texture + "\"string encoding\" \"linear\"" + use)), std::pow(byte, 0.25), 5e-3);
}

TEST(Convert, TexturesAreMixedPixelByPixel) {
  convert::Description scene;
  convert::Pixels pixels{2, 1, {glm::vec4(1, 1, 1, 1), glm::vec4(0, 0, 0, 1)}};
  convert::Texture image;
  image.image = scene.images.add("stripes", pixels, convert::Holds::colors);
  const convert::Texture result =
      convert::mixed(scene, image, convert::constant(0.5), convert::constant(0.5), convert::Holds::colors);
  const convert::Pixels& mixed = scene.images.pixels(result.image);
  EXPECT_NEAR(mixed.values[0].r, 0.75, 5e-3);
  EXPECT_NEAR(mixed.values[1].r, 0.25, 5e-3);
  expect_near(convert::mean(scene, result), glm::dvec3(0.5), 5e-3);
  EXPECT_NEAR(convert::mean(scene, convert::coated_diffuse(scene, image, 1.5).base).x, 0.5, 5e-3);
}

// --- mesh files ---

template <class T>
void put(std::string& out, T value, bool big = false) {
  std::string bytes(reinterpret_cast<const char*>(&value), sizeof(T));
  if (big) std::reverse(bytes.begin(), bytes.end());
  out += bytes;
}

std::string ply_header(const std::string& format) {
  return "ply\nformat " + format +
         " 1.0\ncomment c\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\n"
         "property uchar red\nproperty float u\nproperty float v\nelement face 1\nproperty list uchar int "
         "vertex_indices\nend_header\n";
}

std::string ply_body(bool big) {
  std::string out;
  const float corners[4][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (const auto& corner : corners) {
    put(out, corner[0], big), put(out, static_cast<double>(corner[1]), big), put(out, 2.0f, big);
    put(out, std::uint8_t{7}, big);
    put(out, corner[0], big), put(out, corner[1], big);
  }
  put(out, std::uint8_t{4}, big);
  for (std::int32_t i = 0; i < 4; ++i) put(out, i, big);
  return out;
}

std::string gzipped(const std::string& text) {
  z_stream stream{};
  EXPECT_EQ(deflateInit2(&stream, 6, Z_DEFLATED, 15 + 16, 8, Z_DEFAULT_STRATEGY), Z_OK);
  std::string out(text.size() + 1000, '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()));
  stream.avail_in = static_cast<uInt>(text.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  EXPECT_EQ(deflate(&stream, Z_FINISH), Z_STREAM_END);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  return out;
}

TEST(ConvertMeshes, PlyOfEveryForm) {
  const TempFolder folder;
  const std::string ascii = ply_header("ascii") + "0 0 2 7 0 0\n1 0 2 7 1 0\n1 1 2 7 1 1\n0 1 2 7 0 1\n4 0 1 2 3\n";
  const std::string little = ply_header("binary_little_endian") + ply_body(false);
  for (const std::string& file :
       {ascii, little, ply_header("binary_big_endian") + ply_body(true), gzipped(ascii), gzipped(little)}) {
    const convert::Mesh mesh = convert::read_ply(folder.write("a.ply", file).string(), true);
    ASSERT_EQ(mesh.positions.size(), 4u);
    expect_near(glm::dvec3(mesh.positions[2]), {1.0, 1.0, 2.0});
    EXPECT_EQ(mesh.uvs[3], glm::vec2(0.0f, 0.0f)); // v grows upwards in the file
    EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  }
}

TEST(ConvertMeshes, ObjCountsFromBothEnds) {
  const TempFolder folder;
  const convert::Mesh mesh = convert::read_obj(folder
                                                   .write("a.obj",
                                                          "# c\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 .25\nvn 0 0 "
                                                          "1\nf 1/1/1 2/1/1 3/1/1\nf -4/1/1 -2/1/1 -1/1/1\n")
                                                   .string(),
                                               true);
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_EQ(mesh.indices, (std::vector<std::uint32_t>{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(mesh.uvs[0], glm::vec2(0.0f, 0.75f));
  EXPECT_EQ(mesh.normals[0], glm::vec3(0.0f, 0.0f, 1.0f));
}

std::string serialized_file(std::uint32_t count) {
  std::string file;
  std::vector<std::uint64_t> offsets;
  for (std::uint32_t m = 0; m < count; ++m) {
    std::string mesh;
    put(mesh, std::uint32_t{0x1000 | 2});
    mesh += std::string("name\0", 5);
    put(mesh, std::uint64_t{3}), put(mesh, std::uint64_t{1});
    for (int i = 0; i < 3; ++i)
      put(mesh, static_cast<float>(m)), put(mesh, i == 1 ? 1.0f : 0.0f), put(mesh, i == 2 ? 1.0f : 0.0f);
    for (int i = 0; i < 6; ++i) put(mesh, 0.5f);
    for (std::uint32_t i = 0; i < 3; ++i) put(mesh, i);
    uLongf size = compressBound(mesh.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(mesh.data()), mesh.size());
    offsets.push_back(file.size());
    put(file, std::uint16_t{0x041c}), put(file, std::uint16_t{4});
    file += packed.substr(0, size);
  }
  for (const std::uint64_t offset : offsets) put(file, offset);
  put(file, count);
  return file;
}

TEST(ConvertMeshes, SerializedByItsIndex) {
  const TempFolder folder;
  const std::string path = folder.write("a.serialized", serialized_file(3)).string();
  for (std::uint32_t m = 0; m < 3; ++m)
    EXPECT_EQ(convert::read_serialized(path, m).positions[0].x, static_cast<float>(m));
  EXPECT_THROW(convert::read_serialized(path, 3), Error);
}

TEST(ConvertMeshes, ShapesHaveTheirAreaAndFaceOutwards) {
  const double pi = 3.141592653589793;
  const glm::dmat4 one(1.0);
  EXPECT_NEAR(convert::area(convert::sphere(), one), 4.0 * pi, 0.02);
  const convert::Mesh ball = convert::sphere();
  for (std::size_t t = 0; t + 2 < ball.indices.size(); t += 3) {
    const auto at = [&](std::size_t k) { return glm::dvec3(ball.positions[ball.indices[t + k]]); };
    ASSERT_GT(glm::length(glm::cross(at(1) - at(0), at(2) - at(0))), 1e-6); // none without an area at the poles
  }
  EXPECT_NEAR(convert::area(convert::cylinder(), one), 2.0 * pi, 0.01);
  EXPECT_NEAR(convert::area(convert::disk(), one), pi, 0.01);
  EXPECT_NEAR(convert::area(convert::disk(0.5), one), 0.75 * pi, 0.01);
  EXPECT_NEAR(convert::area(convert::rectangle(), one), 4.0, 1e-9);
  EXPECT_NEAR(convert::area(convert::cube(), one), 24.0, 1e-9);
  for (const convert::Mesh& mesh : {convert::sphere(), convert::cube()}) {
    double volume = 0.0;
    for (std::size_t t = 0; t + 2 < mesh.indices.size(); t += 3) {
      const auto at = [&](std::size_t k) { return glm::dvec3(mesh.positions[mesh.indices[t + k]]); };
      volume += glm::dot(at(0), glm::cross(at(1), at(2))) / 6.0;
    }
    EXPECT_GT(volume, 4.0);
  }
  // A subdivided octahedron lies within it, and nears a ball.
  convert::Mesh octahedron;
  octahedron.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  octahedron.indices = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
  const convert::Mesh round = convert::subdivided(octahedron, 3);
  EXPECT_EQ(round.indices.size(), octahedron.indices.size() * 64);
  float lo = 10.0f, hi = 0.0f;
  for (const glm::vec3& p : round.positions) lo = std::min(lo, glm::length(p)), hi = std::max(hi, glm::length(p));
  EXPECT_LT(hi / lo, 1.2f);
  EXPECT_LT(hi, 1.0f);
}

// --- what is refused ---

std::string refusal(const TempFolder& folder, const std::string& name, const std::string& text) {
  try {
    convert_text(folder, name, text);
  } catch (const Error& error) {
    return error.what();
  }
  return "was accepted";
}

TEST(ConvertRefuses, WhatItCannotRead) {
  const std::pair<std::string, std::string> pbrt[] = {
      {"", "has no WorldBegin"},
      {"Camera \"perspective\"\n", "has no WorldBegin"},
      {"WorldBegin\nSphere\n", "line 2: 'Sphere' is no directive"},
      {"WorldBegin\nMaterial \"matte\" \"color Kd\" [1 1 1]\n", "material 'matte' is none of pbrt-v4"},
      {"WorldBegin\nShape \"sphere\" \"float radius", "has a string that does not end"},
      {"WorldBegin\nShape \"sphere\" \"float radius\" [1", "has a list that does not end"},
      {"WorldBegin\nShape \"sphere\" \"float radius\" [1e999x]", "is no value"},
      {"WorldBegin\nShape \"trianglemesh\" \"point3 P\" [0 0 0] \"integer indices\" [0 1 2]",
       "vertex 1 among its indices"},
      {"WorldBegin\nShape \"trianglemesh\" \"integer indices\" [0 1 2]", "no points"},
      {"WorldBegin\nAttributeEnd", "an end without a begin"},
      {"WorldBegin\nObjectInstance \"a\"", "object 'a' is not there"},
      {"WorldBegin\nNamedMaterial \"a\"", "material 'a' is not there"},
      {"WorldBegin\nInclude \"scene.pbrt\"", "includes a file within itself"},
      {"WorldBegin\nInclude \"none.pbrt\"", "none.pbrt: cannot be read"},
      {"WorldBegin\nShape \"plymesh\" \"string filename\" \"none.ply\"", "none.ply: cannot be read"},
      {"WorldBegin\nMaterial \"diffuse\" \"texture reflectance\" \"t\"", "texture 't' is not there"},
      {"WorldBegin\nLightSource \"infinite\" \"string filename\" \"none.exr\"", "none.exr"},
      {"WorldBegin\n", "neither shapes nor lights nor a camera"}};
  for (const auto& [text, expected] : pbrt) {
    const TempFolder folder;
    const std::string message = refusal(folder, "scene.pbrt", text);
    EXPECT_NE(message.find(expected), std::string::npos) << message << "\nexpected: " << expected;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "out.glb")) << text;
  }
  const std::pair<std::string, std::string> mitsuba[] = {
      {"", "is no valid XML"},
      {"<a/>", "is no scene of Mitsuba"},
      {"<scene>\n<shape type='obj'/></scene>", "line 2: names no file"},
      {"<scene><shape", "is no valid XML"},
      {"<scene><shape type='cube'><ref id='x'/></shape></scene>", "'x' is not there"},
      {"<scene><shape type='sphere'><float name='radius' value='$r'/></shape></scene>", "parameter '$r' has no value"},
      {"<scene><include filename='scene.xml'/></scene>", "include"},
      {"<scene><shape type='cube'><bsdf type='twosided' id='a'><ref id='a'/></bsdf></shape></scene>",
       "nests BSDFs too deep"},
      {"<scene><shape type='sphere'><float name='radius' value='x'/></shape></scene>", "no number"}};
  for (const auto& [text, expected] : mitsuba) {
    const TempFolder folder;
    const std::string message = refusal(folder, "scene.xml", text);
    EXPECT_NE(message.find(expected), std::string::npos) << message << "\nexpected: " << expected;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

// Converted or refused, whatever becomes of a file: cut at every byte, and with bytes of other values.
TEST(ConvertRefuses, DamagedFilesWithoutACrash) {
  const TempFolder folder;
  folder.write("m.ply", ply_header("binary_little_endian") + ply_body(false));
  folder.write("m.serialized", serialized_file(2));
  const std::string pbrt =
      "LookAt 0 0 -5 0 0 0 0 1 0\nCamera \"perspective\" \"float fov\" 40\nFilm \"rgb\" \"integer xresolution\" 8\n"
      "WorldBegin\nMakeNamedMaterial \"a\" \"string type\" \"conductor\" \"float roughness\" .1\n"
      "NamedMaterial \"a\"\nAreaLightSource \"diffuse\" \"blackbody L\" 5000\nShape \"plymesh\" \"string filename\" "
      "\"m.ply\"\n"
      "AttributeBegin Scale 2 2 2 Shape \"disk\" \"float innerradius\" .5 AttributeEnd\n" +
      kTriangle + "LightSource \"spot\" \"rgb I\" [1 2 3]\n";
  const std::string xml =
      "<scene version='3.0.0'><default name='a' value='.25'/><shape type='serialized'><string name='filename' "
      "value='m.serialized'/><integer name='shape_index' value='1'/><transform name='to_world'><lookat "
      "origin='0,0,1' target='0,0,0' up='0,1,0'/><scale value='2'/></transform><bsdf type='roughplastic'>"
      "<float name='alpha' value='$a'/></bsdf></shape></scene>";
  const std::string ply = ply_header("ascii") + "0 0 2 7 0 0\n1 0 2 7 1 0\n1 1 2 7 1 1\n0 1 2 7 0 1\n4 0 1 2 3\n";
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nvt 0 1\nvn 0 0 1\nf 1/1/1 2//1 3/1\n";
  std::mt19937 random(7);
  const auto attempt = [&](const std::string& name, const std::string& contents) {
    const std::string path = folder.write(name, contents).string();
    try {
      if (name.ends_with(".ply"))
        convert::read_ply(path, true);
      else if (name.ends_with(".obj"))
        convert::read_obj(path, true);
      else if (name.ends_with(".serialized"))
        convert::read_serialized(path, 1);
      else
        convert::convert_scene(path, (folder.path() / "out.glb").string());
    } catch (const Error& error) {
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  };
  const std::pair<std::string, std::string> files[] = {
      {"f.pbrt", pbrt},       {"f.xml", xml},
      {"f.ply", ply},         {"g.ply", ply_header("binary_big_endian") + ply_body(true)},
      {"f.obj", obj},         {"f.serialized", serialized_file(2)},
      {"h.ply", gzipped(ply)}};
  for (const auto& [name, contents] : files) {
    const std::size_t step = name.ends_with(".pbrt") || name.ends_with(".xml") ? 5 : 1;
    for (std::size_t size = 0; size < contents.size(); size += step) attempt(name, contents.substr(0, size));
    for (int i = 0; i < 200; ++i) {
      std::string damaged = contents;
      for (int k = 0; k < 1 + i % 4; ++k) damaged[random() % damaged.size()] = static_cast<char>(random());
      attempt(name, damaged);
    }
  }
}

TEST(ConvertRefuses, MeshesThatClaimMoreThanTheyHold) {
  const TempFolder folder;
  const auto message = [&](const std::string& text) {
    try {
      convert::read_ply(folder.write("a.ply", text).string(), false);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("was accepted");
  };
  const std::string many =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
      "property float z\nend_header\nabc";
  EXPECT_NE(message(many).find("is cut short"), std::string::npos);
  EXPECT_NE(message("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
                    "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 9\n")
                .find("vertex that does not exist"),
            std::string::npos);
}

// --- what is told ---

TEST(Convert, LossesHaveCounts) {
  const TempFolder folder;
  const Result result = of_pbrt(
      folder,
      "WorldBegin\nShape \"curve\" \"point3 P\" [0 0 0 1 1 1 2 2 2 3 3 3]\nShape \"curve\" \"point3 P\" [0 0 "
      "0]\nMaterial \"hair\"\n" +
          kTriangle + "Texture \"t\" \"float\" \"fbm\"\nMaterial \"diffuse\" \"float sharpness\" 2\n" + kTriangle);
  EXPECT_EQ(lost(result.converted, "shape 'curve' left out"), 2u);
  EXPECT_EQ(lost(result.converted, "material 'hair': diffuse grey instead"), 1u);
  EXPECT_EQ(lost(result.converted, "texture 'fbm'"), 1u);
  EXPECT_EQ(lost(result.converted, "parameter 'sharpness' of material 'diffuse' ignored"), 1u);
}

TEST(ConvertMitsuba, ValuesThatNothingReadsAreNamed) {
  const TempFolder folder;
  const Result result = of_mitsuba(
      folder,
      "<bsdf type='diffuse' id='paint'><rgb name='reflectance' value='0.5'/><float name='gloss' value='1'/></bsdf>"
      "<shape type='sphere'><float name='radius' value='2'/><boolean name='isVisible' value='true'/><ref id='paint'/>"
      "</shape><shape type='sphere'><float name='radius' value='2'/><ref id='paint'/></shape>"
      "<emitter type='point'><rgb name='intensity' value='1'/><float name='sampling_weight' value='2'/></emitter>");
  EXPECT_EQ(lost(result.converted, "parameter 'gloss' of bsdf 'diffuse' ignored"), 1u);
  EXPECT_EQ(lost(result.converted, "parameter 'is_visible' of shape 'sphere' ignored"), 1u);
  for (const char* name : {"sampling_weight", "radius", "reflectance", "intensity"})
    EXPECT_EQ(lost(result.converted, "'" + std::string(name) + "'"), 0u);
}

TEST(Convert, GltfWithItsBinaryBesideIsTheSameScene) {
  const TempFolder folder;
  const std::string input = folder.write("scene.pbrt", "WorldBegin\n" + kTriangle).string();
  const std::string output = (folder.path() / "a.gltf").string();
  const Converted converted = convert::convert_scene(input, output);
  EXPECT_EQ(converted.files, (std::vector<std::string>{output, (folder.path() / "a.bin").string()}));
  EXPECT_EQ(load_gltf(output).meshes[0].positions.size(), 3u);
  EXPECT_THROW(convert::convert_scene(input, (folder.path() / "a.obj").string()), UsageError);
  EXPECT_THROW(convert::convert_scene(output, (folder.path() / "b.glb").string()), UsageError);
}

TEST(ForeignFiles, AreNamedWithTheCommandThatConvertsThem) {
  const TempFolder folder;
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {"a.obj", "v 0 0 0\n", "is an OBJ mesh, not glTF; convert it: assimp export "},
      {"a.bin", "ply\nformat ascii 1.0\n", "is a PLY mesh"},
      {"a.gltf", "Kaydara FBX Binary  ", "is an FBX file"},
      {"a.stl", "solid a\n", "is an STL mesh"},
      {"a.3ds", "MM", "is a 3DS file"},
      {"a.dae", "<?xml version='1.0'?><COLLADA/>", "is a Collada file"},
      {"a.usda", "#usda 1.0\n", "is a USD file, not glTF; convert it: blender --background --python-expr "},
      {"a", "PXR-USDC\0\0", "is a USD file"},
      {"a.usdz", "PK\3\4", "is a USD file"},
      {"a.blend", "BLENDER-v304", "is a Blender file"},
      {"a.pbrt", "WorldBegin\n", "is a scene of pbrt, not glTF; convert it: wavepath convert "},
      {"a.xml", "<?xml version='1.0'?>\n<scene version='3.0.0'/>", "is a scene of Mitsuba"}};
  for (const auto& [name, contents, expected] : cases) {
    const std::filesystem::path path = folder.write(name, contents);
    try {
      load_gltf(path);
      ADD_FAILURE() << name << " was accepted";
    } catch (const Error& error) {
      EXPECT_NE(std::string(error.what()).find(path.string() + ": " + expected), std::string::npos) << error.what();
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  }
  EXPECT_FALSE(gltf::foreign_file(folder.write("scene.obj", "{\"asset\": {}}")).has_value()); // glTF by another name
}

} // namespace
} // namespace wavepath
