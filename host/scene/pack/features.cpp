// Derives feature bits from what was packed; see features.h.
#include "host/scene/pack/features.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/overloaded.h"
#include "host/scene/pack/bodies.h"
#include "host/scene/pack/light_tree.h"
#include "host/scene/pack/lights.h"
#include "host/scene/pack/materials.h"

namespace wavepath {
namespace {

gpu::Feature bit_if(bool condition, gpu::Feature bit) { return condition ? bit : 0u; }

template <typename Predicate>
bool any_used_material(const Scene& scene, const Usage& usage, Predicate predicate) {
  for (std::size_t m = 0; m < scene.materials.size(); ++m)
    if (usage.material_used[m] && predicate(scene.materials[m])) return true;
  return false;
}

bool transmits(const Material& m) { return !m.unlit && m.transmission > 0.0f; }

// KHR_materials_specular scales F0 and F90 alike, so that a factor of 0 leaves Lambert's base alone.
bool reflects_specularly(const Material& m) {
  return !m.unlit && (m.metallic > 0.0f || m.specular > 0.0f || transmits(m) || layer_lobes(m) != 0);
}

bool attenuates(const Material& m) {
  return !m.unlit && (m.transmission > 0.0f || m.diffuse_transmission > 0.0f) && m.volume &&
         glm::any(glm::greaterThan(m.attenuation, glm::vec3(0.0f)));
}

bool shines(const Material& m) { return m.unlit || glm::any(glm::greaterThan(m.emission, glm::vec3(0.0f))); }

// The code that reads the material's textures. Filtering and transforms are decided by what is packed, see below.
gpu::Feature texture_features(const Material& m) {
  gpu::Feature features = 0;
  visit_textures(
      m, [&](const MaterialTexture& row, const TextureSlot&) { features |= gpu::kFeatureTextures | row.feature; });
  return features;
}

bool transforms_texture(const Material& m) {
  bool found = false;
  visit_textures(m, [&](const MaterialTexture&, const TextureSlot& slot) { found |= slot.transformed(); });
  return found;
}

bool has_unfiltered_texture(const Material& m) {
  bool found = false;
  visit_textures(m, [&](const MaterialTexture&, const TextureSlot& slot) { found |= slot.nearest; });
  return found;
}

gpu::Feature material_features(const Scene& scene, const Usage& usage) {
  gpu::Feature features = 0;
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    if (!usage.material_used[i]) continue;
    const Material& m = scene.materials[i];
    features |= texture_features(m) | bit_if(reflects_specularly(m), gpu::kFeatureSpecular) |
                bit_if(transmits(m), gpu::kFeatureTransmission) | bit_if(attenuates(m), gpu::kFeatureVolume) |
                bit_if(shines(m), gpu::kFeatureEmission) |
                bit_if(!m.unlit && needs_tangents(m), gpu::kFeatureNormalMaps) | layer_lobes(m);
  }
  if (bodies_overlap(scene)) features |= gpu::kLobeNested | gpu::kFeatureVolume;
  return features;
}

// Bodies displace the volume, so that paths have to know which ones they are in; shadow rays then pass no walls.
gpu::Feature volume_features(const Scene& scene, const Usage& usage, bool has_volume) {
  if (!has_volume) return 0;
  return gpu::kFeatureVoxels | bit_if(scene.volume->shines(), gpu::kFeatureFire) |
         bit_if(any_used_material(scene, usage, [](const Material& m) { return is_body(m); }), gpu::kFeatureVolume);
}

gpu::Feature light_features(const PackedScene& packed) {
  gpu::Feature features = 0;
  for (const gpu::Light& light : packed.lights) {
    if (light.kind == gpu::kLightTriangle)
      features |= gpu::kFeatureTriangleLights;
    else if (light.kind != gpu::kLightEnvironment)
      features |= gpu::kFeaturePunctualLights | bit_if(light.pdf_area > 0.0f, gpu::kFeatureSoftLamps) |
                  bit_if(light.kind == gpu::kLightPoint && light.parts != 0, gpu::kFeatureLightProfiles);
  }
  features |=
      bit_if(glm::any(glm::greaterThan(packed.environment_radiance, glm::vec3(0.0f))), gpu::kFeatureEnvironment);
  return features | bit_if(!packed.environment.empty(), gpu::kFeatureEnvironmentMap) |
         bit_if(!packed.light_tree.empty(), gpu::kFeatureLightTree);
}

gpu::Feature page_features(std::size_t texel_words) {
  constexpr std::size_t kPage = std::size_t{1} << gpu::kTexelPageShift;
  return bit_if(texel_words > kPage, gpu::kFeatureTexelPages2) |
         bit_if(texel_words > 2 * kPage, gpu::kFeatureTexelPages4) |
         bit_if(texel_words > 4 * kPage, gpu::kFeatureTexelPages16);
}

} // namespace

gpu::Feature find_features(const Scene& scene, const Usage& usage, const PackedScene& packed) {
  std::uint32_t flags = 0;
  for (const gpu::Triangle& triangle : packed.triangles) flags |= triangle.surface;
  std::uint32_t texture_flags = 0, mip_count = 0;
  bool exact = false;
  for (const gpu::Texture& texture : packed.textures) {
    texture_flags |= texture.flags, mip_count |= texture.mip_count;
    exact |= !(texture.flags & gpu::kTextureSampled);
  }
  const bool sampled = (texture_flags & gpu::kTextureSampled) != 0;
  return material_features(scene, usage) | light_features(packed) | bit_if(packed.root_is_top, gpu::kFeatureInstances) |
         bit_if(flags & gpu::kTriangleAlpha, gpu::kFeatureAlpha) |
         bit_if((flags & gpu::kTrianglePane) && !packed.lights.empty(), gpu::kFeaturePanes) |
         bit_if(any_used_material(scene, usage, may_be_wall) && !packed.lights.empty() && !packed.voxels,
                gpu::kFeatureWalls) |
         volume_features(scene, usage, packed.voxels != nullptr) |
         bit_if(flags & gpu::kTriangleSingleSided, gpu::kFeatureCull) |
         bit_if(flags & gpu::kTriangleSmooth, gpu::kFeatureSmoothNormals) |
         bit_if(!packed.vertex_colors.empty(), gpu::kFeatureVertexColors) |
         bit_if(texture_flags & gpu::kTextureMoved, gpu::kFeatureTextureTransform) |
         bit_if(texture_flags & gpu::kTextureFloat, gpu::kFeatureFloatTextures) |
         bit_if(mip_count > 0, gpu::kFeatureMips) | page_features(packed.texels.size()) |
         bit_if(sampled, gpu::kFeatureSampledTextures) | bit_if(sampled && exact, gpu::kFeatureExactTextures) |
         bit_if(texture_flags & gpu::kTextureNearest, gpu::kFeatureNearestTextures);
}

gpu::Feature expected_features(const Scene& scene, std::uint32_t direct) {
  const Usage usage = find_usage(scene);
  const auto any = [&](auto predicate) { return any_used_material(scene, usage, predicate); };
  const bool lights = std::any_of(scene.lights.begin(), scene.lights.end(), [](const PunctualLight& light) {
    return glm::any(glm::greaterThan(light.intensity, glm::vec3(0.0f)));
  });
  const bool sampled = direct != gpu::kDirectBsdf;
  const bool lit = scene.environment.present();
  return material_features(scene, usage) | bit_if(usage.two_level(), gpu::kFeatureInstances) |
         bit_if(any([](const Material& m) { return m.unlit || m.alpha_mode != AlphaMode::opaque; }),
                gpu::kFeatureAlpha) |
         bit_if(sampled && any(may_be_pane), gpu::kFeaturePanes) |
         bit_if(sampled && any(may_be_wall), gpu::kFeaturePanes) |
         bit_if(sampled && any(may_be_wall) && !scene.volume, gpu::kFeatureWalls) |
         volume_features(scene, usage, scene.volume.has_value()) |
         bit_if(any([](const Material& m) {
                  return !m.double_sided && !(m.transmission > 0.0f) && !(m.diffuse_transmission > 0.0f);
                }),
                gpu::kFeatureCull) |
         bit_if(usage.smooth, gpu::kFeatureSmoothNormals) | bit_if(usage.colored, gpu::kFeatureVertexColors) |
         bit_if(any(transforms_texture), gpu::kFeatureTextureTransform) |
         bit_if(any(has_unfiltered_texture), gpu::kFeatureNearestTextures) |
         bit_if(sampled && any([](const Material& m) { return !m.unlit && shines(m); }), gpu::kFeatureTriangleLights) |
         bit_if(sampled && count_emitters(scene, usage) + scene.lights.size() > kFewLights, gpu::kFeatureLightTree) |
         bit_if(sampled && lights, gpu::kFeaturePunctualLights) |
         bit_if(sampled && !scene.profiles.empty(), gpu::kFeatureLightProfiles) |
         bit_if(lit, gpu::kFeatureEnvironment) |
         bit_if(lit && !scene.environment.map.empty(), gpu::kFeatureEnvironmentMap);
}

std::vector<LeftOut> list_left_out(const Usage& usage, const PackedScene& packed, std::uint32_t direct) {
  const bool no_sampling = direct == gpu::kDirectBsdf;
  const std::uint64_t stream = usage.vertex_count * sizeof(glm::vec4);
  const std::uint64_t corners = packed.triangle_vertices.empty() ? packed.triangles.size() * sizeof(glm::uvec4) : 0;
  const std::string not_sampled = "--direct bsdf samples no light";
  const char* kNoMaterial = "no material in use has it";
  std::vector<LeftOut> all = {
      {"two-level BVH", "no mesh is shown more than once", sizeof(gpu::Instance) + sizeof(bvh::WideNode),
       gpu::kFeatureInstances},
      {"alpha test", "no surface lets rays through by its alpha", 0, gpu::kFeatureAlpha},
      {"shadow rays through panes", no_sampling ? not_sampled : "no light, or no thin smooth glass", 0,
       gpu::kFeaturePanes},
      {"shadow rays through walls of bodies of ior 1", no_sampling ? not_sampled : "no light, or no such body", 0,
       gpu::kFeatureWalls},
      {"culling of back faces", "every surface is double-sided or transmissive", 0, gpu::kFeatureCull},
      {"textures", "no material in use has a texture", packed.vertex_uvs.empty() ? stream : 0, gpu::kFeatureTextures},
      {"mip levels of textures", "no frame of one sample asks for them", absent_mip_bytes(packed.textures),
       gpu::kFeatureMips},
      {"texel pages", "all texels in use fit one buffer of 256 MiB", 0, gpu::kFeatureTexelPages},
      {"textures of floats", "all texels in use are bytes", 0, gpu::kFeatureFloatTextures},
      {"unfiltered textures", "every texture in use is filtered", 0, gpu::kFeatureNearestTextures},
      {"texture transforms", "no texture in use is moved, turned or scaled", 0, gpu::kFeatureTextureTransform},
      {"smooth normals", "no primitive has vertex normals", packed.vertex_normals.empty() ? stream : 0,
       gpu::kFeatureSmoothNormals},
      {"vertex colours", "no mesh has vertex colours", stream, gpu::kFeatureVertexColors},
      {"specular reflection", "every material is pure Lambert or unlit", 0, gpu::kFeatureSpecular},
      {"transmission", "no material in use transmits light", 0, gpu::kFeatureTransmission},
      {"volume medium per path", "no body in use absorbs light (this would take 4 bytes a path)", 0,
       gpu::kFeatureVolume},
      {"surface emission", "no material in use shines", 0, gpu::kFeatureEmission},
      {"triangle lights", no_sampling ? not_sampled : "no triangle shines", 0, gpu::kFeatureTriangleLights},
      {"punctual lights", no_sampling ? not_sampled : "the scene has none that shines", 0, gpu::kFeaturePunctualLights},
      {"light tree", no_sampling ? not_sampled : "lights are few enough to pick by power",
       light_tree_bytes(packed.local_light_count), gpu::kFeatureLightTree},
      {"clear coats", kNoMaterial, 0, gpu::kLobeCoat},
      {"sheen", kNoMaterial, 0, gpu::kLobeSheen},
      {"anisotropy", kNoMaterial, 0, gpu::kLobeAnisotropy},
      {"iridescence", kNoMaterial, 0, gpu::kLobeIridescence},
      {"diffuse transmission", kNoMaterial, 0, gpu::kLobeDiffuseTransmission},
      {"dispersion", kNoMaterial, 0, gpu::kLobeDispersion},
      {"scattering in volumes", kNoMaterial, 0, gpu::kLobeScattering},
      {"bodies that overlap", "no two bodies that light passes through meet", 0, gpu::kLobeNested},
      {"multiple scattering between microfacets", "no rough metal or rough glass is in use", 0, gpu::kLobeMultiple},
      {"environment", "it is black", 0, gpu::kFeatureEnvironment},
      {"environment map", "the environment is constant or black", 0, gpu::kFeatureEnvironmentMap},
  };
  gpu::Feature listed = gpu::kLobesAll; // two slots may share a bit, and lobes stand above
  visit_material_fields(Overloaded{[](const auto&) {},
                                   [&](const MaterialTexture& row) {
                                     if (!(listed & row.feature))
                                       all.push_back({row.plural, "no material in use has one", 0, row.feature});
                                     listed |= row.feature;
                                   }});
  std::erase_if(all, [&](const LeftOut& entry) { return (packed.features & entry.feature) != 0; });
  // These entries have no feature: the code has bindings that a scene without a volume does not fill.
  if (!(packed.features & gpu::kFeatureVoxels))
    all.push_back({"volume of voxels", "the scene has none"});
  else if (!(packed.features & gpu::kFeatureFire))
    all.push_back({"black bodies in the volume", "no part of it is hot"});
  if (const AlphaCounts& alpha = packed.alpha; alpha.opaque + alpha.holes > 0)
    all.push_back(
        {"alpha look-ups",
         fmt::format("{} of {} triangles are opaque, {} are holes", alpha.opaque, alpha.total(), alpha.holes),
         alpha.holes * (sizeof(gpu::Triangle) + (packed.triangle_vertices.empty() ? 0 : sizeof(glm::uvec4)))});
  if (corners > 0)
    all.push_back(
        {"vertex indices", "no surface has vertex normals, texture coordinates or colours to look up", corners});
  return all;
}

std::string lacked_lobes(const PackedScene& packed, gpu::Feature lacked) {
  const gpu::Feature found = packed.features & lacked;
  if (!found) return "";
  const char* what = found & gpu::kLobeDispersion   ? "glass that disperses light"
                     : found & gpu::kLobeScattering ? "volumes that scatter light"
                                                    : "a volume of voxels";
  return fmt::format("cannot render {}, which the scene has", what);
}

void refuse_lobes(const PackedScene& packed, gpu::Feature lacked, std::string_view integrator) {
  if (const std::string problem = lacked_lobes(packed, lacked); !problem.empty())
    throw Error("--integrator " + std::string(integrator), problem, "use --integrator path");
}

} // namespace wavepath
