// Specialization constants of kernels: feature bits and settings.
#ifndef WAVEPATH_FEATURES_H
#define WAVEPATH_FEATURES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// ---- what a scene needs: the bits of the specialization constants kFeatures and kLobes ------------------------------
// A clear bit removes the code; the host then also leaves out the data. Setting a bit that the scene does not need
// changes no result, only speed ("generic kernels"). The host keeps both words in one: lobes are its upper half.
#ifdef __cplusplus
using Feature = std::uint64_t;
#define GPU_LOBE(n) (std::uint64_t{1} << (32 + (n)))
#else
#define Feature uint
#define GPU_LOBE(n) (1u << (n))
#endif

GPU_CONSTANT Feature kFeatureInstances = 1u << 0; // a top-level tree over instances
GPU_CONSTANT Feature kFeatureAlpha = 1u << 1;     // MASK, BLEND or unlit triangles, tested during traversal
GPU_CONSTANT Feature kFeatureCull = 1u << 2;      // single-sided triangles, which rays may pass from behind (kSpecCull)
GPU_CONSTANT Feature kFeatureTextures = 1u << 3;  // any material texture
GPU_CONSTANT Feature kFeatureTextureTransform = 1u << 4;
GPU_CONSTANT Feature kFeatureNormalMaps = 1u << 5;    // normal maps, and everything else that needs tangents
GPU_CONSTANT Feature kFeatureSmoothNormals = 1u << 6; // vertex normals
GPU_CONSTANT Feature kFeatureVertexColors = 1u << 7;
GPU_CONSTANT Feature kFeatureSpecular = 1u << 8; // any reflection besides Lambert's
GPU_CONSTANT Feature kFeatureTransmission = 1u << 9;
GPU_CONSTANT Feature kFeatureVolume = 1u << 10;         // attenuation; adds a medium to the path state
GPU_CONSTANT Feature kFeatureEmission = 1u << 11;       // emissive surfaces, unlit ones included
GPU_CONSTANT Feature kFeatureTriangleLights = 1u << 12; // emissive triangles that next-event estimation samples
GPU_CONSTANT Feature kFeaturePunctualLights = 1u << 13;
GPU_CONSTANT Feature kFeatureEnvironment = 1u << 14;    // any environment radiance
GPU_CONSTANT Feature kFeatureEnvironmentMap = 1u << 15; // a lat-long image rather than a constant
GPU_CONSTANT Feature kFeatureAovs = 1u << 16;           // extra output channels
GPU_CONSTANT Feature kFeatureOrthographic = 1u << 17;
GPU_CONSTANT Feature kFeatureBaseColorTextures = 1u << 18;
GPU_CONSTANT Feature kFeatureMetallicRoughnessTextures = 1u << 19;
GPU_CONSTANT Feature kFeatureSpecularTextures = 1u << 20; // for the specular factor or its colour
GPU_CONSTANT Feature kFeatureTransmissionTextures = 1u << 21;
GPU_CONSTANT Feature kFeatureEmissionTextures = 1u << 22;
GPU_CONSTANT Feature kFeatureFloatTextures = 1u << 23;   // texels of four floats
GPU_CONSTANT Feature kFeatureNearestTextures = 1u << 24; // unfiltered look-ups
GPU_CONSTANT Feature kFeatureAdaptive = 1u << 25;        // waves follow a list of entries, by levels
                                                         // (wave.h), and generate keeps samplers
// All paths of a pixel in a wave begin at one first hit and belong to one replicate.
GPU_CONSTANT Feature kFeatureSharedFirstHit = 1u << 26;
GPU_CONSTANT Feature kFeatureLightTree = 1u << 27;  // many local lights: picked by a walk down a tree
GPU_CONSTANT Feature kFeatureLightCells = 1u << 28; // local lights: trained probabilities for each cell of space
GPU_CONSTANT Feature kFeatureGuide = 1u << 29;      // directions are also drawn from a trained field
GPU_CONSTANT Feature kFeaturePanes = 1u << 30;      // thin smooth panes, or walls, that shadow rays pass
GPU_CONSTANT Feature kFeaturesAll = (1u << 31) - 1u;
// Training passes only: kernels record data to train lights, sky and guide.
GPU_CONSTANT Feature kFeatureTraining = 1u << 31;

// Lobes of a material beyond glTF's metallic-roughness model (kernels/surface/layers.glsl).
GPU_CONSTANT Feature kLobeCoat = GPU_LOBE(0);
GPU_CONSTANT Feature kLobeSheen = GPU_LOBE(1);
GPU_CONSTANT Feature kLobeAnisotropy = GPU_LOBE(2);
GPU_CONSTANT Feature kLobeIridescence = GPU_LOBE(3);
GPU_CONSTANT Feature kLobeDiffuseTransmission = GPU_LOBE(4);
GPU_CONSTANT Feature kLobeDispersion = GPU_LOBE(5);
GPU_CONSTANT Feature kLobeScattering = GPU_LOBE(6); // scattering in volumes
GPU_CONSTANT Feature kLobeNested = GPU_LOBE(7);     // bodies that overlap
GPU_CONSTANT Feature kLobeMultiple = GPU_LOBE(8);   // light that scatters more than once between rough microfacets
GPU_CONSTANT Feature kLobesAll = GPU_LOBE(9) - GPU_LOBE(0);
// Textures have mip levels, for frames of one sample: no lobe, but a bit of that word.
GPU_CONSTANT Feature kFeatureMips = GPU_LOBE(9);
GPU_CONSTANT Feature kFeatureTexelPages2 = GPU_LOBE(10);  // texels fill more than one page, likewise no lobes
GPU_CONSTANT Feature kFeatureTexelPages4 = GPU_LOBE(11);  // more than two
GPU_CONSTANT Feature kFeatureTexelPages16 = GPU_LOBE(12); // more than four
GPU_CONSTANT Feature kFeatureTexelPages = GPU_LOBE(13) - GPU_LOBE(10);
// The device's samplers look textures up; kernels without this bit have other bindings.
GPU_CONSTANT Feature kFeatureSampledTextures = GPU_LOBE(13);
// Some textures are looked up by kernels although kFeatureSampledTextures is set.
GPU_CONSTANT Feature kFeatureExactTextures = GPU_LOBE(14);
// Parts of the environment map are picked with trained probabilities.
GPU_CONSTANT Feature kFeatureLearnedSky = GPU_LOBE(15);
// Bodies of ior 1, whose walls shadow rays pass; set besides kFeaturePanes.
GPU_CONSTANT Feature kFeatureWalls = GPU_LOBE(16);
// The camera is more than a pinhole or parallel rays about the picture's middle (camera_model.glsl).
GPU_CONSTANT Feature kFeatureCameraModel = GPU_LOBE(17);
// Albedo and normal are those of what mirrors and smooth glass show (aovs_through.glsl).
GPU_CONSTANT Feature kFeatureAovsThrough = GPU_LOBE(21);
// Punctual lights that have an extent, which rays can meet (kernels/light/soft_lamps.glsl).
GPU_CONSTANT Feature kFeatureSoftLamps = GPU_LOBE(20);
// Light is also added up by groups of lights (kernels/path/light_groups.glsl); kernels with this bit have more
// bindings.
GPU_CONSTANT Feature kFeatureLightGroups = GPU_LOBE(19);
// Point lights whose intensity goes by direction (kernels/light/light_sampling.glsl).
GPU_CONSTANT Feature kFeatureLightProfiles = GPU_LOBE(22);
// A volume of voxels (kernels/volume); kernels with this bit have more bindings.
GPU_CONSTANT Feature kFeatureVoxels = GPU_LOBE(23);
GPU_CONSTANT Feature kFeatureFire = GPU_LOBE(24); // whose hot parts shine; set besides kFeatureVoxels
// The camera moves nearly as fast as light (relativity.glsl); set besides kFeatureCameraModel.
GPU_CONSTANT Feature kFeatureRelativity = GPU_LOBE(25);
// Paths tell what of a pixel is transparent or in shadow (cover_types.h); kernels with this bit have more bindings.
GPU_CONSTANT Feature kFeatureCover = GPU_LOBE(18);
GPU_CONSTANT Feature kLobesLayered = GPU_LOBE(8) - GPU_LOBE(0); // lobes that only the LAYERED builds of kernels have

// ---- specialization constants ---------------------------------------------------------------------------------------
GPU_CONSTANT uint kSpecFeatures = 0u;
GPU_CONSTANT uint kSpecStackSize = 1u; // traversal stack entries; the BVH says how many suffice
GPU_CONSTANT uint kSpecSampler = 2u;
GPU_CONSTANT uint kSpecDirect = 3u;
GPU_CONSTANT uint kSpecHemisphere = 4u;
GPU_CONSTANT uint kSpecFilter = 5u;
GPU_CONSTANT uint kSpecWalk = 6u;    // how lanes walk through the BVH; changes no result
GPU_CONSTANT uint kSpecProbing = 7u; // whether pictures may have error probes; gpu::Frame says whether they have
GPU_CONSTANT uint kSpecLobes = 8u;   // kLobe bits
GPU_CONSTANT uint kSpecLens = 9u;    // shape of the camera's aperture: kLensPinhole, kLensDisc, or a number of blades
GPU_CONSTANT uint kSpecCull = 10u;   // rays that pass single-sided surfaces from behind (kFeatureCull)
GPU_CONSTANT uint kSpecMotion = 11u; // 1: corners of triangles move while the shutter is open (gpu::Frame)
GPU_CONSTANT uint kSpecTerminator = 12u;   // start of rays at surfaces with vertex normals
GPU_CONSTANT uint kSpecSort = 13u;         // lists that extend makes for the next kernels: hits, escaped rays
GPU_CONSTANT uint kSpecLightSamples = 14u; // light samples where a path first scatters; 1 to kMostLightSamples
GPU_CONSTANT uint kSpecSky = 15u; // whether shadow rays look for a sky of one colour, too; gpu::Frame says how many
GPU_CONSTANT uint kSpecLaneRays = 16u; // rays that a lane takes from a queue at most (trace_queue.glsl); at least 1
GPU_CONSTANT uint kSpecReuse = 17u;    // whether pixels may share paths; gpu::Frame says whether they do
GPU_CONSTANT uint kSpecClamp = 18u;    // bits of the largest radiance of a sample (--clamp); 0: no limit
GPU_CONSTANT uint kSpecCount = 19u;

GPU_CONSTANT uint kSamplerIndependent = 0u, kSamplerStratified = 1u, kSamplerSobol = 2u;
GPU_CONSTANT uint kDirectMis = 0u, kDirectNee = 1u, kDirectBsdf = 2u;
GPU_CONSTANT uint kHemisphereCosine = 0u, kHemisphereUniform = 1u;
GPU_CONSTANT uint kLightsAuto = 0u, kLightsPower = 1u, kLightsTree = 2u, kLightsLearned = 3u;
GPU_CONSTANT uint kProbingOff = 0u, kProbingOn = 1u; // see kernels/base/error_probes.h
GPU_CONSTANT uint kWalkByLane = 0u, kWalkInStep = 1u;
GPU_CONSTANT uint kLensPinhole = 0u, kLensDisc = 1u; // from 3 on: number of corners of a regular polygon
GPU_CONSTANT uint kCullCamera = 0u, kCullAll = 1u, kCullNone = 2u;
GPU_CONSTANT uint kTerminatorFacets = 0u, kTerminatorSmooth = 1u;
GPU_CONSTANT uint kSortNone = 0u, kSortHits = 1u, kSortEscapes = 2u; // escapes besides hits
GPU_CONSTANT uint kSkyByPaths = 0u, kSkyByShadowRays = 1u;           // besides paths
GPU_CONSTANT uint kReuseNone = 0u, kReuseQuads = 1u;                 // see kernels/path/reuse.glsl
GPU_CONSTANT uint kMostLightSamples = 8u;
GPU_CONSTANT uint kFilterBox = 0u, kFilterGaussian = 1u, kFilterBlackmanHarris = 2u,
                  kFilterCentre = 3u; // every ray through the middle of its pixel: host/integrators/path/first_hits.h

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
