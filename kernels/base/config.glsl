// The specialization constants, declared once: what is switched off here folds away when the pipeline is compiled.
// The defaults are the generic kernel: every feature, and the settings that the command line starts from.
#ifndef WAVEPATH_CONFIG_GLSL
#define WAVEPATH_CONFIG_GLSL

#include "kernels/base/features.h"

layout(constant_id = kSpecFeatures) const uint kFeatures = kFeaturesAll;
layout(constant_id = kSpecLobes) const uint kLobes = kLobesAll; // without LAYERED only of kLobeMultiple, see
                                                                // bsdf_types.glsl
layout(constant_id = kSpecStackSize) const uint kStackSize = 160u;
layout(constant_id = kSpecWalk) const uint kWalk = kWalkByLane;
layout(constant_id = kSpecSampler) const uint kSampler = kSamplerSobol;
layout(constant_id = kSpecDirect) const uint kDirect = kDirectMis;
layout(constant_id = kSpecHemisphere) const uint kHemisphere = kHemisphereCosine;
layout(constant_id = kSpecProbing) const uint kProbing = kProbingOn;
layout(constant_id = kSpecLens) const uint kLens = kLensPinhole;
layout(constant_id = kSpecCull) const uint kCull = kCullCamera;
layout(constant_id = kSpecMotion) const uint kMotion = 0u;
layout(constant_id = kSpecTerminator) const uint kTerminator = kTerminatorFacets;
layout(constant_id = kSpecSort) const uint kSort = kSortNone;
layout(constant_id = kSpecLightSamples) const uint kLightSamples = 1u;
layout(constant_id = kSpecLaneRays) const uint kLaneRays = 256u;
layout(constant_id = kSpecSky) const uint kSky = kSkyByPaths;
layout(constant_id = kSpecReuse) const uint kReuse = kReuseNone;
layout(constant_id = kSpecClamp) const uint kClamp = 0u;
layout(constant_id = kSpecFilter) const uint kFilter = kFilterBlackmanHarris;

const bool kInStep = kWalk == kWalkInStep;
// True if single-sided surfaces let some rays pass from behind; and if these are camera rays only.
#define CULLS_BACKS (has(kFeatureCull) && kCull != kCullNone)
#define CULLS_ALL_BACKS (has(kFeatureCull) && kCull == kCullAll)
// Macros, so that conditions are constants before anything is inlined: see host/gpu/trim_spirv.h.
#define has(feature) ((kFeatures & (feature)) != 0u)
#define has_lobe(lobe) ((kLobes & (lobe)) != 0u)
// True if some surface is more than diffuse.
const bool kMicrofacets = (kFeatures & (kFeatureSpecular | kFeatureTransmission)) != 0u;
// True if there is a volume; and if its hot parts shine.
#define HAS_VOXELS has_lobe(kFeatureVoxels)
#define HAS_FIRE has_lobe(kFeatureFire)
bool has_mips() { return has_lobe(kFeatureMips); }

#endif
