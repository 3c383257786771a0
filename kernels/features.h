// What kernels are specialized for: feature bits and settings.
#ifndef WAVEPATH_FEATURES_H
#define WAVEPATH_FEATURES_H

#include "kernels/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// ---- what a scene needs: the bits of the specialization constant kFeatures ------------------------------------------
// A clear bit removes the code; the host then also leaves out the data. Setting a bit that the scene does not need
// changes no result, only speed ("generic kernels").
GPU_CONSTANT uint kFeatureInstances = 1u << 0; // a top-level tree over instances
GPU_CONSTANT uint kFeatureAlpha = 1u << 1;     // MASK, BLEND or unlit triangles, tested during traversal
GPU_CONSTANT uint kFeatureCull = 1u << 2;      // single-sided triangles, which rays may pass from behind (kSpecCull)
GPU_CONSTANT uint kFeatureTextures = 1u << 3;  // any material texture
GPU_CONSTANT uint kFeatureTextureTransform = 1u << 4;
GPU_CONSTANT uint kFeatureNormalMaps = 1u << 5;
GPU_CONSTANT uint kFeatureSmoothNormals = 1u << 6; // vertex normals
GPU_CONSTANT uint kFeatureVertexColors = 1u << 7;
GPU_CONSTANT uint kFeatureSpecular = 1u << 8; // any reflection besides Lambert's
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
GPU_CONSTANT uint kFeatureAdaptive = 1u << 25;        // waves follow a list of runs of pixels
GPU_CONSTANT uint kFeatureSharedFirstHit =
    1u << 26; // all paths of a pixel in a wave begin at one first hit and belong to one replicate
GPU_CONSTANT uint kFeatureLightTree = 1u << 27; // many local lights: picked by a walk down a tree
GPU_CONSTANT uint kFeatureLightRows = 1u << 28; // in shares that a pilot has learned
GPU_CONSTANT uint kFeatureGuide = 1u << 29;     // directions are also drawn from a learned field
GPU_CONSTANT uint kFeaturePanes = 1u << 30;     // thin smooth panes that shadow rays pass
GPU_CONSTANT uint kFeaturesAll = (1u << 31) - 1u;
GPU_CONSTANT uint kFeatureLearning =
    1u << 31; // of pilots alone: their kernels note what light rows and guide learn from

// ---- specialization constants ---------------------------------------------------------------------------------------
GPU_CONSTANT uint kSpecFeatures = 0u;
GPU_CONSTANT uint kSpecStackSize = 1u; // traversal stack entries; the BVH says how many suffice
GPU_CONSTANT uint kSpecSampler = 2u;
GPU_CONSTANT uint kSpecDirect = 3u;
GPU_CONSTANT uint kSpecHemisphere = 4u;
GPU_CONSTANT uint kSpecFilter = 5u;
GPU_CONSTANT uint kSpecStack = 6u;   // where the traversal stack lives; changes no result
GPU_CONSTANT uint kSpecNets = 7u;    // whether pixels may have whole nets; gpu::Frame says whether they have
GPU_CONSTANT uint kSpecLens = 9u;    // shape of the camera's aperture: kLensPinhole, kLensDisc, or a number of blades
GPU_CONSTANT uint kSpecCull = 10u;   // which rays single-sided surfaces let pass from behind (kFeatureCull)
GPU_CONSTANT uint kSpecMotion = 11u; // 1: corners of triangles move while the shutter is open (gpu::Frame)
GPU_CONSTANT uint kSpecCount = 12u;

GPU_CONSTANT uint kSamplerIndependent = 0u, kSamplerStratified = 1u, kSamplerSobol = 2u;
GPU_CONSTANT uint kDirectMis = 0u, kDirectNee = 1u, kDirectBsdf = 2u;
GPU_CONSTANT uint kHemisphereCosine = 0u, kHemisphereUniform = 1u;
GPU_CONSTANT uint kLightsAuto = 0u, kLightsPower = 1u, kLightsTree = 2u, kLightsLearned = 3u;
GPU_CONSTANT uint kNetsHalved = 0u, kNetsWhole = 1u; // see kernels/net_layout.h
GPU_CONSTANT uint kStackArray = 0u, kStackRegisters = 1u;
GPU_CONSTANT uint kLensPinhole = 0u, kLensDisc = 1u; // from 3 on: a regular polygon of so many corners
GPU_CONSTANT uint kCullCamera = 0u, kCullAll = 1u, kCullNone = 2u;
GPU_CONSTANT uint kFilterBox = 0u, kFilterGaussian = 1u, kFilterBlackmanHarris = 2u;

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
