// Every struct and constant that host and kernels share, written once and compiled by both languages.
//
// Layout rule: vec3 is always followed by a scalar, vec4 starts at a multiple of 16, so that the offsets of
// std430, std140 and C++ coincide; tests/layout_test.cpp compares them with what SPIR-V says.
// Spaces: "world" on the device is the scene's world moved so that `Scene::origin` is zero. Units: glTF's (metres, radiance).
#ifndef WAVEPATH_GPU_TYPES_H
#define WAVEPATH_GPU_TYPES_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
#define GPU_CONSTANT inline constexpr
#define GPU_CHECK(condition) static_assert(condition)
namespace wavepath::gpu {
using uint = std::uint32_t;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#else
#define GPU_CONSTANT const
#define GPU_CHECK(condition)
#endif

GPU_CONSTANT uint kNone = 0xffffffffu;
GPU_CONSTANT uint kWorkgroupSize = 64u;

// ---- what a scene needs: the bits of the specialization constant kFeatures -------------------------------------------------
// A clear bit removes the code; the host then also leaves out the data. Setting a bit that the scene does not need changes no
// result, only speed ("generic kernels").
GPU_CONSTANT uint kFeatureInstances = 1u << 0;       // two-level BVH
GPU_CONSTANT uint kFeatureAlpha = 1u << 1;           // MASK or BLEND triangles, tested during traversal
GPU_CONSTANT uint kFeatureCull = 1u << 2;            // single-sided triangles are invisible from behind
GPU_CONSTANT uint kFeatureTextures = 1u << 3;        // any material texture
GPU_CONSTANT uint kFeatureTextureTransform = 1u << 4;
GPU_CONSTANT uint kFeatureNormalMaps = 1u << 5;
GPU_CONSTANT uint kFeatureSmoothNormals = 1u << 6;   // vertex normals
GPU_CONSTANT uint kFeatureVertexColors = 1u << 7;
GPU_CONSTANT uint kFeatureSpecular = 1u << 8;        // any reflection besides Lambert's
GPU_CONSTANT uint kFeatureTransmission = 1u << 9;
GPU_CONSTANT uint kFeatureVolume = 1u << 10;         // attenuation; adds a medium to the path state
GPU_CONSTANT uint kFeatureEmission = 1u << 11;       // emissive surfaces, unlit ones included
GPU_CONSTANT uint kFeatureTriangleLights = 1u << 12; // emissive triangles that next-event estimation samples
GPU_CONSTANT uint kFeaturePunctualLights = 1u << 13;
GPU_CONSTANT uint kFeatureEnvironment = 1u << 14;    // any environment radiance
GPU_CONSTANT uint kFeatureEnvironmentMap = 1u << 15; // a lat-long image rather than a constant
GPU_CONSTANT uint kFeatureAovs = 1u << 16;           // extra output channels
GPU_CONSTANT uint kFeatureOrthographic = 1u << 17;
GPU_CONSTANT uint kFeatureBaseColorTextures = 1u << 18;
GPU_CONSTANT uint kFeatureMetallicRoughnessTextures = 1u << 19;
GPU_CONSTANT uint kFeatureSpecularTextures = 1u << 20; // of the specular factor or its colour
GPU_CONSTANT uint kFeatureTransmissionTextures = 1u << 21;
GPU_CONSTANT uint kFeatureEmissionTextures = 1u << 22;
GPU_CONSTANT uint kFeatureFloatTextures = 1u << 23;   // texels of four floats
GPU_CONSTANT uint kFeatureNearestTextures = 1u << 24; // unfiltered look-ups
GPU_CONSTANT uint kFeatureAdaptive = 1u << 25; // waves follow a list of runs of pixels
GPU_CONSTANT uint kFeatureHybrid = 1u << 26;   // paths begin in a rasterized frame
GPU_CONSTANT uint kFeaturesAll = (1u << 27) - 1u;

// ---- specialization constants ---------------------------------------------------------------------------------------------
GPU_CONSTANT uint kSpecFeatures = 0u;
GPU_CONSTANT uint kSpecStackSize = 1u; // traversal stack entries; the BVH says how many suffice
GPU_CONSTANT uint kSpecSampler = 2u;
GPU_CONSTANT uint kSpecDirect = 3u;
GPU_CONSTANT uint kSpecHemisphere = 4u;
GPU_CONSTANT uint kSpecFilter = 5u;
GPU_CONSTANT uint kSpecStack = 6u; // where the traversal stack lives; changes no result
GPU_CONSTANT uint kSpecCount = 7u;

GPU_CONSTANT uint kSamplerIndependent = 0u, kSamplerStratified = 1u, kSamplerSobol = 2u;
GPU_CONSTANT uint kDirectMis = 0u, kDirectNee = 1u, kDirectBsdf = 2u;
GPU_CONSTANT uint kHemisphereCosine = 0u, kHemisphereUniform = 1u;
GPU_CONSTANT uint kStackArray = 0u, kStackRegisters = 1u;
GPU_CONSTANT uint kFilterBox = 0u, kFilterGaussian = 1u, kFilterBlackmanHarris = 2u;

// ---- descriptor bindings, one set for all kernels -------------------------------------------------------------------------
// Read-only data goes through uniform texel buffers: on lavapipe (Mesa 22.3) they traverse twice as fast as storage buffers.
GPU_CONSTANT uint kBindFrame = 0u;             // uniform Frame
GPU_CONSTANT uint kBindNodes = 1u;             // texels RGBA32UI, kNodeTexels each: bvh::WideNode
GPU_CONSTANT uint kBindTriangles = 2u;         // texels RGBA32F, kTriangleTexels each: Triangle, in BVH leaf order
GPU_CONSTANT uint kBindTriangleVertices = 3u;  // texels RGBA32UI, one a triangle: three vertex indices, unused
GPU_CONSTANT uint kBindVertexNormals = 4u;     // texels RGBA32F, one a vertex: normal, packed tangent (see pack_tangent)
GPU_CONSTANT uint kBindVertexUvs = 5u;         // texels RGBA32F, one a vertex: TEXCOORD_0, TEXCOORD_1
GPU_CONSTANT uint kBindVertexColors = 6u;      // texels RGBA32F, one a vertex: COLOR_0, linear
GPU_CONSTANT uint kBindInstances = 7u;         // texels RGBA32F, kInstanceTexels each: Instance
GPU_CONSTANT uint kBindMaterials = 8u;         // texels RGBA32UI, kMaterialTexels each: Material
GPU_CONSTANT uint kBindTextures = 9u;          // texels RGBA32UI, kTextureTexels each: Texture
GPU_CONSTANT uint kBindTexels = 10u;           // texels R32UI: one word a texel (RGBA8) or four (RGBA32F)
GPU_CONSTANT uint kBindSrgbTable = 11u;        // texels R32F, 256: byte -> linear
GPU_CONSTANT uint kBindLights = 12u;           // texels RGBA32UI, kLightTexels each: Light
GPU_CONSTANT uint kBindEnvironment = 13u;      // texels RGBA32F: radiance, probability of the texel
GPU_CONSTANT uint kBindEnvironmentAlias = 14u; // texels RG32UI: float bits of the threshold, alias
GPU_CONSTANT uint kBindPaths = 15u;            // storage PathState[], one a slot
GPU_CONSTANT uint kBindRays = 16u;             // storage Ray[]: two queues, read and written in turn
GPU_CONSTANT uint kBindRayTexels = 17u;        // texels RGBA32F: the same memory, for reading
GPU_CONSTANT uint kBindHits = 18u;             // storage Hit[], one a ray in the queue
GPU_CONSTANT uint kBindShadowRays = 19u;       // storage ShadowRay[]
GPU_CONSTANT uint kBindQueues = 20u;           // storage Queues
GPU_CONSTANT uint kBindFilm = 21u;             // storage FilmPixel[], kReplicates a pixel
GPU_CONSTANT uint kBindPathMedia = 22u;        // storage uint[], one a slot: material whose inside the path is in (kFeatureVolume)
GPU_CONSTANT uint kBindPathAovs = 23u;         // storage PathAovs[], one a slot (kFeatureAovs)
GPU_CONSTANT uint kBindFilmAovs = 24u;         // storage FilmAovs[], one a pixel (kFeatureAovs)
// The same memory for reading: each is written and read by one lane, or with a barrier in between.
GPU_CONSTANT uint kBindPathTexels = 25u;      // texels RGBA32F
GPU_CONSTANT uint kBindHitTexels = 26u;       // texels RGBA32UI
GPU_CONSTANT uint kBindShadowRayTexels = 27u; // texels RGBA32UI
GPU_CONSTANT uint kBindFilmTexels = 28u;      // texels RGBA32UI
GPU_CONSTANT uint kBindRuns = 29u;            // texels R32UI: runs of kRunPixels pixels in tile order (kFeatureAdaptive)

// Of the hybrid integrators, see kernels/hybrid.glsl. Everything a pixel has is row-major from the top left there.
GPU_CONSTANT uint kBindHybrid = 30u;     // uniform HybridFrame
GPU_CONSTANT uint kBindVisibility = 31u; // texels RG32UI: place in the triangle buffer, instance; kNone where nothing is seen
GPU_CONSTANT uint kBindGbuffer = 32u;    // storage GbufferPixel[]
GPU_CONSTANT uint kBindSignals = 33u;    // storage vec4[]: reflected direct light over demodulation(albedo), unoccluded share
GPU_CONSTANT uint kBindSeen = 34u;       // storage vec4[]: light that reaches the eye without a bounce, share of the albedo that is no mirror
GPU_CONSTANT uint kBindJitters = 35u;    // storage vec2[kJitters]: HybridFrame::jitter of frames to come

// ---- geometry -------------------------------------------------------------------------------------------------------------
GPU_CONSTANT uint kNodeTexels = 3u;     // 48 bytes, see bvh/wide.h
GPU_CONSTANT uint kCellBias = 66u;      // of the exponents of a node's grid
GPU_CONSTANT uint kTriangleTexels = 3u; // 48 bytes
GPU_CONSTANT uint kInstanceTexels = 7u;

// A leaf that waits to be tested: kLeafBit | item count << kLeafCountShift | first item. Items are triangles, or instances in
// the top level of a two-level tree.
GPU_CONSTANT uint kLeafBit = 0x80000000u;
GPU_CONSTANT uint kLeafCountShift = 28u;
GPU_CONSTANT uint kLeafFirstMask = 0x0fffffffu;

// Bits of Triangle::surface; the rest is the index of its material.
GPU_CONSTANT uint kTriangleSingleSided = 1u << 31; // invisible from behind
GPU_CONSTANT uint kTriangleAlpha = 1u << 30;       // its material is MASK or BLEND
GPU_CONSTANT uint kTriangleSmooth = 1u << 29;      // has vertex normals
GPU_CONSTANT uint kTriangleMaterialMask = kTriangleSmooth - 1u;

// Object space for instanced meshes, device world space for everything else. A tree with spatial splits holds copies of a
// triangle; all that chooses between triangles goes by `id`, so that no picture depends on how the tree was built.
struct Triangle {
  vec3 v0;
  uint surface;
  vec3 v1;
  uint id; // among the triangles of its object, in the order of the source
  vec3 v2;
  float light_pdf; // pdf per unit world area with which next-event estimation picks a point on it; 0 = not a light
};
GPU_CHECK(sizeof(Triangle) == 16 * kTriangleTexels);

// A placed object. Rows of 3x4 matrices. `flipped`: the transform mirrors, so front and back change places.
struct Instance {
  vec4 object_from_world[3];
  vec4 world_from_object[3];
  uint root;    // node at which traversal of the object starts
  uint flipped; // 0 or 1
  uint id;      // in the order of the source
  uint pad0;
};
GPU_CHECK(sizeof(Instance) == 16 * kInstanceTexels);

// ---- materials and textures -----------------------------------------------------------------------------------------------
GPU_CONSTANT uint kMaterialDoubleSided = 1u << 0;
GPU_CONSTANT uint kMaterialMask = 1u << 1;
GPU_CONSTANT uint kMaterialBlend = 1u << 2;
GPU_CONSTANT uint kMaterialUnlit = 1u << 3;
GPU_CONSTANT uint kMaterialVolume = 1u << 4; // a closed volume: refracts; otherwise transmission is thin-walled

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

GPU_CONSTANT uint kWrapRepeat = 0u, kWrapClamp = 1u, kWrapMirror = 2u;
GPU_CONSTANT uint kTextureWrapUShift = 0u; // two bits each
GPU_CONSTANT uint kTextureWrapVShift = 2u;
GPU_CONSTANT uint kTextureNearest = 1u << 4;
GPU_CONSTANT uint kTextureSrgb = 1u << 5;   // RGB are sRGB bytes; alpha is linear
GPU_CONSTANT uint kTextureFloat = 1u << 6;  // four float words a texel, already linear
GPU_CONSTANT uint kTextureUv1 = 1u << 7;    // TEXCOORD_1
GPU_CONSTANT uint kTextureMoved = 1u << 8;  // uv_matrix and uv_offset apply

// An image as one material slot sees it. uv' = (dot(uv_matrix.xy, uv), dot(uv_matrix.zw, uv)) + uv_offset.
struct Texture {
  uint first_texel; // word index into the texel buffer
  uint width;
  uint height;
  uint flags;
  vec4 uv_matrix;
  vec2 uv_offset;
  uint pad0;
  uint pad1;
};
GPU_CONSTANT uint kTextureTexels = 3u;
GPU_CHECK(sizeof(Texture) == 16 * kTextureTexels);

// ---- lights ---------------------------------------------------------------------------------------------------------------
GPU_CONSTANT uint kLightTriangle = 0u;
GPU_CONSTANT uint kLightPoint = 1u;
GPU_CONSTANT uint kLightSpot = 2u;
GPU_CONSTANT uint kLightDirectional = 3u;
GPU_CONSTANT uint kLightEnvironment = 4u;

// A light, and its column of the power-weighted alias table (Walker 1977, Vose 1991): pick i = floor(u.x*n), keep it if
// u.y < threshold, else take `alias`.
struct Light {
  vec3 position; // punctual, device world space
  uint kind;
  vec3 direction; // directional: towards the light. Spot: the axis, away from the light
  float probability; // of being picked
  vec3 intensity; // candela (point, spot) or lux (directional)
  float threshold;
  uint alias;
  uint triangle;    // kLightTriangle: one of its copies
  uint instance;    // kLightTriangle; 0 where the scene is not instanced
  uint triangle_id; // kLightTriangle
  float spot_scale; // cosine falloff: clamp(cos*scale + offset, 0, 1)^2, as KHR_lights_punctual gives it
  float spot_offset;
  float pad1;
  float pad2;
};
GPU_CONSTANT uint kLightTexels = 5u;
GPU_CHECK(sizeof(Light) == 16 * kLightTexels);

// ---- one render -----------------------------------------------------------------------------------------------------------
// Camera rays: origin = camera_position (+ x*camera_right + y*camera_up, orthographic), direction = camera_forward
// (+ x*camera_right + y*camera_up, perspective), with x, y in [-1,1], y upwards; right and up carry the image's half extent.
struct Frame {
  vec3 camera_position;
  uint width;
  vec3 camera_right;
  uint height;
  vec3 camera_up;
  uint max_depth;
  vec3 camera_forward;
  uint seed;
  vec3 environment_radiance; // constant environment, or the scale of the map
  float environment_probability; // of next-event estimation picking the environment
  vec2 environment_rotation; // cos, sin: direction in the map = rotation about +Y of the world direction
  uint environment_width;
  uint environment_height;
  uint light_count;
  uint root;        // node where traversal starts
  uint root_is_top; // 1: the root is the top level of a two-level tree, leaves hold instances
  uint orthographic;
  uint sample_total; // samples a pixel that the stratified sampler spreads over
  uint slot_count;   // capacity of one ray queue
  uint scene_features; // kFeature bits that the scene has data for, whatever the kernels were compiled with
  uint pad0;
};
GPU_CHECK(sizeof(Frame) == 128);

GPU_CONSTANT uint kRunPixels = 64u; // that an adaptive render gives samples to together: a tile of 8x8, away from the borders

// Push constants: the wave of (pixel, sample) pairs that a dispatch works on. Slot = local sample * pixel_count + local pixel.
struct Wave {
  uint first_pixel; // in tile order; where runs are listed, in the order of their list
  uint pixel_count;
  uint first_sample;
  uint sample_count;
  uint bounce; // 0 = camera rays
  uint first_film_pixel; // pixel, in tile order, of the film's first entry
};

struct PathState {
  vec3 throughput;
  float bsdf_pdf; // of the direction being traced; negative after a delta lobe (no next-event estimation could find it)
  vec3 radiance;
  float eta_scale; // product of squared relative iors crossed, undone for Russian roulette
};
GPU_CHECK(sizeof(PathState) == 32);

GPU_CONSTANT float kFar = 3.402823466e38f; // t_max of a ray that nothing bounds

struct Ray {
  vec3 origin;
  uint slot;
  vec3 direction; // unit length
  float t_max;
};
GPU_CHECK(sizeof(Ray) == 32);

struct Hit {
  uint triangle; // kNone = miss
  uint instance;
  float b1; // barycentric weight of v1
  float b2;
};
GPU_CHECK(sizeof(Hit) == 16);

struct ShadowRay {
  vec3 origin;
  uint slot;
  vec3 direction; // to the point on the light, not normalized: t in (0,1); unit length and t_max = kFar for distant lights
  float t_max;
  vec3 contribution; // what the path gains if nothing is in between
  uint light;        // Light that it goes to
};
GPU_CHECK(sizeof(ShadowRay) == 48);

// The kernels that can make a sample not finite.
GPU_CONSTANT uint kMakerGenerate = 0u, kMakerShade = 1u, kMakerConnect = 2u;
GPU_CONSTANT uint kMakerCount = 3u;

struct Queues {
  uint ray_count[2];
  uint shadow_count;
  uint pad0;
  uint extend_groups[3]; // indirect dispatch sizes; shade uses extend's
  uint pad1;
  uint connect_groups[3];
  uint pad2;
  uint camera_rays[2]; // 64-bit totals: low, high
  uint bounce_rays[2];
  uint shadow_rays[2];
  uint occlusion_rays[2];
  uint nonfinite_count[kMakerCount]; // of this wave, by the kernel that made them
  uint nonfinite_first[kMakerCount]; // their lowest slots, kNone if there are none
};
GPU_CHECK(sizeof(Queues) == 104);

// ---- hybrid rendering -----------------------------------------------------------------------------------------------------
// One frame of a hybrid render: every pixel is seen through the same place of its filter, so that the frame can be rasterized.
struct HybridFrame {
  vec2 jitter; // of that place from the pixel's centre, in pixels, x to the right and y downwards
  float near;  // distance of the near plane along the view axis
  float far;   // of the far plane, orthographic cameras only
  vec3 ambient; // radiance that stands for all light of more than one bounce
  float ao_radius; // metres from which on nothing occludes; kFar = unlimited
  uint sample_index; // this frame's, as the film counts
  uint shadow_samples; // light samples a pixel and frame
  uint ao_samples;
  uint flags; // kHybrid bits
};
GPU_CHECK(sizeof(HybridFrame) == 48);
GPU_CONSTANT uint kJitters = 1024u;
GPU_CONSTANT uint kHybridLights = 1u << 0;  // direct light is wanted
GPU_CONSTANT uint kHybridAmbient = 1u << 1; // the ambient term is wanted
GPU_CONSTANT uint kHybridToColor = 1u << 2;   // composite leaves the frame in `seen`, for a filter,
GPU_CONSTANT uint kHybridFromColor = 1u << 3; // and takes it from there
GPU_CONSTANT float kDemodulationFloor = 0.1f; // see demodulation()

// What rasterization found, as filters need it.
struct GbufferPixel {
  vec3 normal; // shading normal, world, on the side of the eye
  float depth; // distance along the view axis, metres; 0 = nothing was seen
  vec3 albedo; // base colour
  uint surface; // same value = same placed mesh and material: what a filter may mix
};
GPU_CHECK(sizeof(GbufferPixel) == 32);

// How a frame was seen: the camera as Frame has it (forward of unit length), and the place within each pixel.
struct CameraView {
  vec3 position;
  uint orthographic;
  vec3 right;
  float jitter_x; // from the pixel's centre, in pixels, to the right
  vec3 up;
  float jitter_y; // and downwards
  vec3 forward;
  float pad0;
};
GPU_CHECK(sizeof(CameraView) == 64);

// Two frames of a camera that moves through a standing scene, for filters over time.
struct Reprojection {
  CameraView now;
  CameraView before;
  uint width;
  uint height;
  uint remembers; // 1: there is a frame before
  uint still;     // 1: the camera stands as it did then, but for the jitter
};
GPU_CHECK(sizeof(Reprojection) == 144);

// Push constants of the filters. They work on tiles of kFilterTile x kFilterTile pixels, one a workgroup, row-major.
struct FilterBand {
  uint first_tile;
  uint step; // a-trous: from one tap to the next, in pixels
};
GPU_CONSTANT uint kFilterTile = 8u;
GPU_CHECK(kFilterTile * kFilterTile == kWorkgroupSize);

// Bindings of the filters, in a set of their own.
GPU_CONSTANT uint kFilterReprojection = 0u;  // uniform Reprojection
GPU_CONSTANT uint kFilterGbuffer = 1u;       // texels RGBA32UI, two a pixel: GbufferPixel
GPU_CONSTANT uint kFilterColorIn = 2u;       // texels RGBA32F
GPU_CONSTANT uint kFilterColorOut = 3u;      // storage vec4[]
GPU_CONSTANT uint kFilterHistoryBefore = 4u; // texels RGBA32F
GPU_CONSTANT uint kFilterHistoryNow = 5u;    // storage vec4[]
// Of the denoiser alone, see kernels/denoise.glsl.
GPU_CONSTANT uint kFilterPastBefore = 6u;     // texels RGBA32UI: packed shape, frames in the history
GPU_CONSTANT uint kFilterPastNow = 7u;        // storage uvec4[]
GPU_CONSTANT uint kFilterPastTexels = 8u;     // texels RGBA32UI: the same memory, for reading
GPU_CONSTANT uint kFilterMomentsBefore = 9u;  // texels RGBA32F: mean and variance of the direct light, of the unoccluded share
GPU_CONSTANT uint kFilterMomentsNow = 10u;    // storage vec4[]
GPU_CONSTANT uint kFilterMomentsTexels = 11u; // texels RGBA32F: the same memory, for reading
GPU_CONSTANT uint kFilterGuideIn = 12u;       // texels RGBA32UI: packed shape, standard errors
GPU_CONSTANT uint kFilterGuideOut = 13u;      // storage uvec4[]
GPU_CONSTANT uint kFilterSlopes = 14u;        // storage vec2[]: change of disparity from pixel to pixel
GPU_CONSTANT uint kFilterSlopeTexels = 15u;   // texels RG32UI: the same memory, for reading

// ---- film -----------------------------------------------------------------------------------------------------------------
// Sample s belongs to replicate s % kReplicates; replicates are scrambled independently, so that their spread measures the
// error of any sampler.
GPU_CONSTANT uint kReplicates = 2u;

// The exact sum of many floats, in any order (after the reproducible sums of Demmel and Nguyen 2013, with integers). Bit k of digit d weighs
// 2^(32 d + k - 149), so that every float is two whole digits. The two highest digits that any sample reached are kept, each with
// the sum of its own carries in 64 bits: what is kept depends on the set of samples alone. So parts of a render join to the bits
// of the whole, and 10^9 samples wear nothing out; what is lost of a sample is below 2^-32 of the largest one.
struct ExactSum {
  uint high[2]; // of digit `top`: low word, high word, two's complement
  uint low[2];  // of digit `top` - 1
};
GPU_CHECK(sizeof(ExactSum) == 16);

struct FilmPixel {
  ExactSum red, green, blue;
  uint count;    // finite samples so far
  uint tops;     // digit `top` of each sum, a byte each
  float largest; // R + G + B of the largest sample
  uint pad0;
};
GPU_CHECK(sizeof(FilmPixel) == 64);

// First-hit values and light components of one path.
struct PathAovs {
  vec3 albedo;
  float depth; // along the view axis
  vec3 normal; // shading normal, world
  float hit;   // 1 = the camera ray hit something
  vec3 position; // device world
  float unoccluded; // share of the sky over the surface; hybrid integrators only
  vec3 emission; // radiance seen without a bounce
  float pad1;
  vec3 direct; // radiance after one bounce
  float pad2;
};
GPU_CHECK(sizeof(PathAovs) == 80);

// Running means over samples of the fields of PathAovs.
struct FilmAovs {
  vec3 albedo;
  float depth;
  vec3 normal;
  float hits;
  vec3 position;
  float count;
  vec3 emission;
  float unoccluded;
  vec3 direct;
  float pad0;
};
GPU_CHECK(sizeof(FilmAovs) == 80);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
