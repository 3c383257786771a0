// The scene on the device: geometry, materials, textures, lights.
#ifndef WAVEPATH_SCENE_TYPES_H
#define WAVEPATH_SCENE_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// ---- descriptor bindings --------------------------------------------------------------------------------------------
// One set serves all kernels of an integrator: bindings 0 to 15 hold the constants of the render and the scene, 16 to
// 19 the film, those from 20 on what is the integrator's own.
// Read-only data goes through uniform texel buffers: on lavapipe (Mesa 22.3) they traverse twice as fast as storage
// buffers.
// Texels RGBA32UI, kNodeTexels each: bvh::WideNode; for ray queries QueryScene::items.
GPU_CONSTANT uint kBindNodes = 1u;
GPU_CONSTANT uint kBindTriangles = 2u;        // texels RGBA32F, kTriangleTexels each: Triangle, in BVH leaf order
GPU_CONSTANT uint kBindTriangleVertices = 3u; // texels RGBA32UI, one a triangle: three vertex indices, see kPieceId
GPU_CONSTANT uint kBindVertexNormals = 4u;    // texels RGBA32F, one a vertex: normal, packed tangent (see pack_tangent)
GPU_CONSTANT uint kBindVertexUvs = 5u;        // texels RGBA32F, one a vertex: TEXCOORD_0, TEXCOORD_1
GPU_CONSTANT uint kBindVertexColors = 6u;     // texels RGBA32F, one a vertex: COLOR_0, linear
GPU_CONSTANT uint kBindInstances = 7u;        // texels RGBA32F, kInstanceTexels each: Instance
GPU_CONSTANT uint kBindMaterials = 8u;        // texels RGBA32UI: Material, MaterialLayers, albedo tables
GPU_CONSTANT uint kBindTextures = 9u;         // texels RGBA32UI, kTextureTexels each: Texture
GPU_CONSTANT uint kBindTexels = 10u;      // texels R32UI: one word a texel (RGBA8) or four (RGBA32F); the first page
GPU_CONSTANT uint kBindSrgbTable = 11u;   // texels R32F, 256: byte -> linear
GPU_CONSTANT uint kBindLights = 12u;      // texels RGBA32UI, kLightTexels each: Light
GPU_CONSTANT uint kBindEnvironment = 13u; // texels RGBA32F: radiance, probability of the texel
// Texels R32UI: ends of the rows' intervals, then of every row's columns; behind them cuts of the same.
GPU_CONSTANT uint kBindEnvironmentEnds = 14u;

// Texels of more than one page go on in buffers of their own. A page is what every GPU can see as one texel buffer; an
// image may lie across two. Kernels of scenes with one page know no other (kFeatureTexelPages2 and those after it).
GPU_CONSTANT uint kBindTexelPages = 103u; // pages 1 to kTexelPages - 1, as kBindTexels
GPU_CONSTANT uint kTexelPageShift = 26u;  // log2 of the words in a page (256 MiB)
GPU_CONSTANT uint kTexelPages = 16u;

// Images that the device's samplers look up (kFeatureSampledTextures), see host/scene/pack/atlas.h: values, colours.
GPU_CONSTANT uint kBindAtlases = 118u;
GPU_CONSTANT uint kAtlasBorder = 1u; // texels around every image: what linear filters reach

// ---- geometry -------------------------------------------------------------------------------------------------------
GPU_CONSTANT uint kNodeTexels = 3u;     // 48 bytes, see bvh/wide.h
GPU_CONSTANT uint kCellBias = 66u;      // bias of the exponents of a node's grid
GPU_CONSTANT uint kTriangleTexels = 3u; // 48 bytes
GPU_CONSTANT uint kInstanceTexels = 7u;

// A leaf that is still to be tested: kLeafBit | item count << kLeafCountShift | first item. Items are triangles, or
// instances in the top-level tree.
GPU_CONSTANT uint kLeafBit = 0x80000000u;
GPU_CONSTANT uint kLeafCountShift = 28u;
GPU_CONSTANT uint kLeafFirstMask = 0x0fffffffu;

// Bits of Triangle::surface; the rest is the index of its material.
GPU_CONSTANT uint kTriangleSingleSided = 1u << 31; // invisible from behind
GPU_CONSTANT uint kTriangleAlpha = 1u << 30;       // MASK or BLEND that lets some rays pass, or unlit
GPU_CONSTANT uint kTriangleSmooth = 1u << 29;      // has vertex normals
// Its material may be a thin smooth pane, or a body of ior 1: light passes unbent.
GPU_CONSTANT uint kTrianglePane = 1u << 28;
GPU_CONSTANT uint kTriangleMaterialMask = kTrianglePane - 1u;

// Set in the id of a piece that a huge triangle was cut into (host/scene/pack/cut.h), but for the first one, which
// keeps the triangle's: the rest counts the pieces of the scene. Every piece has the triangle's id behind its vertices.
GPU_CONSTANT uint kPieceId = 1u << 28;

// Object space for instanced meshes, device world space for everything else. A tree with spatial splits holds copies of
// a triangle; all that chooses between triangles goes by `id`, so that no picture depends on how the tree was built.
struct Triangle {
  vec3 v0;
  uint surface;
  vec3 v1;
  uint id; // among the triangles of its object, in the order of the source; or see kPieceId
  vec3 v2;
  uint light; // its own, counted from Instance::first_light; kNone: next-event estimation does not pick it
};
GPU_CHECK(sizeof(Triangle) == 16 * kTriangleTexels);

// A placed object. Rows of 3x4 matrices. `flipped`: the transform mirrors, so front and back change places.
struct Instance {
  vec4 object_from_world[3];
  vec4 world_from_object[3];
  uint root;        // node at which traversal of the object starts; see QueryScene for ray queries
  uint flipped;     // 0 or 1
  uint id;          // index in the order of the scene
  uint first_light; // first light of its triangles; 0 in a scene without instances
};
GPU_CHECK(sizeof(Instance) == 16 * kInstanceTexels);

// ---- materials and textures -----------------------------------------------------------------------------------------
GPU_CONSTANT uint kMaterialDoubleSided = 1u << 0;
GPU_CONSTANT uint kMaterialMask = 1u << 1;
GPU_CONSTANT uint kMaterialBlend = 1u << 2;
GPU_CONSTANT uint kMaterialUnlit = 1u << 3;
GPU_CONSTANT uint kMaterialVolume = 1u << 4;    // a closed volume: refracts; otherwise transmission is thin-walled
GPU_CONSTANT uint kMaterialPriorityShift = 16u; // priority of a volume among those that overlap: 1 to 65535

GPU_CONSTANT float kMinSheenAlpha = 1e-3f; // finer fibres would be a spike at grazing angles that nothing samples
// Smoother microfacets (alpha = roughness^2) are a mirror: see kernels/surface/bsdf.glsl.
GPU_CONSTANT float kMinAlpha = 1e-4f;

// Factors of glTF 2.0 and its extensions; texture fields index Texture[] or are kNone.
struct Material {
  vec4 base_color;
  vec3 emission; // radiance: emissiveFactor * emissiveStrength
  uint flags;
  vec3 specular_color;
  float specular;
  vec3 attenuation; // 1/metre: -ln(attenuationColor) / attenuationDistance
  float transmission;
  float metallic;
  float roughness;
  float ior; // 0 stands for infinite, as KHR_materials_ior has it
  float alpha_cutoff;
  float normal_scale;
  uint base_color_texture;
  uint metallic_roughness_texture;
  uint normal_texture;
  uint emission_texture;
  uint specular_texture;
  uint specular_color_texture;
  uint transmission_texture;
};
GPU_CONSTANT uint kMaterialTexels = 7u;
GPU_CHECK(sizeof(Material) == 16 * kMaterialTexels);

// Parameters of a material's further lobes, for the lobes that the scene uses (kLobe bits). Stored behind all
// materials, one record for each, if any material has any of them. A kernel fetches only the fields of the lobes that
// it has.
struct MaterialLayers {
  vec3 sheen_color;
  float sheen_roughness;
  float coat; // clearcoatFactor
  float coat_roughness;
  float coat_normal_scale;
  uint coat_texture;
  uint coat_roughness_texture;
  uint coat_normal_texture;
  uint sheen_color_texture;
  uint sheen_roughness_texture;
  float anisotropy;
  float anisotropy_rotation; // radians, counter-clockwise from the tangent
  uint anisotropy_texture;
  uint layer_tangents; // vertices from one's normal to its tangents of coat and grain; 0 = they have those of the
                       // normal map
  float iridescence;
  float film_ior;
  float film_lo; // thickness in nanometres where the texture is 0
  float film_hi; // and where it is 1, or there is none
  uint iridescence_texture;
  uint film_texture; // G
  float dispersion;
  float scattering_anisotropy;
  vec3 diffuse_transmission_color;
  float diffuse_transmission;
  vec3 scattering; // 1/metre: coefficient of scattering, of the extinction Material::attenuation
  uint diffuse_transmission_texture;
  uint diffuse_transmission_color_texture;
  uint ggx_table; // first texels of albedo tables
  uint sheen_table;
  uint glass_table; // albedo table of rough glass of this ior, from outside; behind it the one from inside
};
GPU_CONSTANT uint kLayerTexels = 9u;
GPU_CHECK(sizeof(MaterialLayers) == 16 * kLayerTexels);

// Albedo tables stand behind the layers (host/scene/pack/albedo_tables.h): kTableCells^2 texels, each with the values
// at the four corners of a cell (those of the lower roughness first, the lower cosine first), then kTableCells + 1
// texels of averages, by roughness. Rows go by roughness, columns by the root of the cosine, both from 0 to 1.
GPU_CONSTANT uint kTableCells = 32u;
GPU_CONSTANT uint kTableTexels = kTableCells * kTableCells + kTableCells + 1u;

GPU_CONSTANT uint kWrapRepeat = 0u, kWrapClamp = 1u, kWrapMirror = 2u;
GPU_CONSTANT uint kTextureWrapUShift = 0u; // two bits each
GPU_CONSTANT uint kTextureWrapVShift = 2u;
GPU_CONSTANT uint kTextureNearest = 1u << 4;
GPU_CONSTANT uint kTextureSrgb = 1u << 5;    // RGB are sRGB bytes; alpha is linear
GPU_CONSTANT uint kTextureFloat = 1u << 6;   // four float words a texel, already linear
GPU_CONSTANT uint kTextureUv1 = 1u << 7;     // TEXCOORD_1
GPU_CONSTANT uint kTextureMoved = 1u << 8;   // uv_matrix and uv_offset apply
GPU_CONSTANT uint kTextureSampled = 1u << 9; // the texture is in an atlas
// Two bits: how many images lie side by side with it (kernels/base/tile_order.h).
GPU_CONSTANT uint kTextureBesideShift = 10u;
GPU_CONSTANT uint kTextureLayerShift = 16u; // above it the layer of the atlas

// An image as one texture of a material uses it. uv' = (dot(uv_matrix.xy, uv), dot(uv_matrix.zw, uv)) + uv_offset.
struct Texture {
  uint first_texel; // word index into the texel buffer; in an atlas its position, x | y << 16
  uint width;
  uint height;
  uint flags;
  vec4 uv_matrix;
  vec2 uv_offset;
  uint mip_count; // levels besides the image itself; 0 unless frames of the render may look them up
  uint first_mip; // word index of the first of them; the others follow. In an atlas they lie beside it
};
GPU_CONSTANT uint kTextureTexels = 3u;
GPU_CHECK(sizeof(Texture) == 16 * kTextureTexels);

// ---- lights ---------------------------------------------------------------------------------------------------------
GPU_CONSTANT uint kLightTriangle = 0u;
GPU_CONSTANT uint kLightPoint = 1u;
GPU_CONSTANT uint kLightSpot = 2u;
GPU_CONSTANT uint kLightDirectional = 3u;
GPU_CONSTANT uint kLightEnvironment = 4u;

// A light, and its interval of the 32-bit integers that it is picked by (host/scene/pack/intervals.h).
struct Light {
  vec3 position; // punctual, device world space
  uint kind;
  vec3 direction;    // directional: towards the light. Spot: the axis, away from the light
  float probability; // probability of being picked
  vec3 intensity;    // candela (point, spot) or lux (directional)
  uint end;          // end of its interval, which begins at the end of the previous light's
  // KLightTriangle: mean density of its points, per unit of world area, the choice of the light included. Others:
  // extent of a soft lamp (kernels/light/soft_lamps.glsl), which is the radius of its sphere, or of a directional light
  // 1 minus the cosine of half its angle; 0 = none.
  float pdf_area;
  uint triangle;    // kLightTriangle: one of its copies
  uint instance;    // kLightTriangle; 0 where the scene is not instanced
  uint triangle_id; // kLightTriangle
  float spot_scale; // cosine falloff: clamp(cos*scale + offset, 0, 1)^2, as KHR_lights_punctual gives it
  float spot_offset;
  // kLightTriangle, where its emission varies: depth << kPartDepthShift | its first word, see below. kLightPoint: 1
  // more than the first word of its profile; 0 = none.
  uint parts;
  float inverse_range; // 1/metre: where a point or spot light has faded to nothing; 0 = nowhere
};
GPU_CONSTANT uint kLightTexels = 5u;

// Behind the lights stand the parts of triangles, four words a texel. See kernels/light/light_sampling.glsl.
GPU_CONSTANT uint kPartDepthShift = 28u;
GPU_CONSTANT uint kFirstPartMask = 0x0fffffffu;
GPU_CHECK(sizeof(Light) == 16 * kLightTexels);

// So do profiles of point lights (kFeatureLightProfiles): words of a light, then those of a table that several may
// have.
GPU_CONSTANT uint kProfileAxis = 0u;    // three floats: direction of vertical angle 0
GPU_CONSTANT uint kProfileTangent = 3u; // of horizontal angle 0, beside it
GPU_CONSTANT uint kProfileTable = 6u;   // first word of the table
GPU_CONSTANT uint kProfileWords = 7u;
// The table: numbers of vertical and horizontal angles, those angles in radians, intensities by horizontal angle.
GPU_CONSTANT uint kProfileAngles = 2u;

// Groups of lights (kFeatureLightGroups): words of a table. Its first words, then the groups of the lights by index, of
// the materials, of the instances and of the triangles. The two last are there if nodes of meshes are told apart: the
// group of a surface is the lesser of that of its material and that of its node.
GPU_CONSTANT uint kBindGroupTable = 125u; // texels R32UI
GPU_CONSTANT uint kGroupCount = 0u;       // number of groups
GPU_CONSTANT uint kGroupEnvironment = 1u; // group of the environment
GPU_CONSTANT uint kGroupMaterials = 2u;   // index of the first word of the materials
GPU_CONSTANT uint kGroupInstances = 3u;   // of the instances; 0 = there are none. kNone: go by the triangle
GPU_CONSTANT uint kGroupTriangles = 4u;   // of the triangles; 0 = there are none
GPU_CONSTANT uint kGroupVolume = 5u;      // group of the volume
GPU_CONSTANT uint kGroupLights = 6u;      // the first word of the lights
GPU_CONSTANT uint kMostLightGroups = 16u;

// Of 2^n intervals there are 2^(n - kCutShift) cuts (host/scene/pack/intervals.h), and no more than 2^kMostCutBits.
GPU_CONSTANT int kCutShift = 2, kMostCutBits = 9;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
