// One frame of a hybrid render, from rasterization to the film.
#ifndef WAVEPATH_HYBRID_TYPES_H
#define WAVEPATH_HYBRID_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

// Everything a pixel has is row-major from the top left here.
GPU_CONSTANT uint kBindHybrid = 32u; // uniform HybridFrame
// Texels RG32UI: index in the triangle buffer, instance; kNone where nothing is seen.
GPU_CONSTANT uint kBindVisibility = 33u;
GPU_CONSTANT uint kBindGbuffer = 34u; // storage GbufferPixel[]
// Storage vec4[]: reflected direct light over demodulation(albedo), unoccluded fraction.
GPU_CONSTANT uint kBindSignals = 35u;
GPU_CONSTANT uint kBindJitters = 36u; // storage vec2[kJitters]: HybridFrame::jitter of frames to come

GPU_CONSTANT uint kBindLayers = 77u; // storage vec4[] (kHybridLayers, kHybridRefractive): light of the layers in front
                                     // of what is opaque, fraction of light they let pass
GPU_CONSTANT uint kBindReflections = 131u; // storage vec4[] (kHybridReflections): what mirrors show of lit surfaces
// Storage vec2[]: pixels that a surface passes while the shutter is open. No frame has reflections as well, so both
// take one binding: devices have few storage buffers a stage.
GPU_CONSTANT uint kBindVelocities = kBindReflections;
// Several frames see a pixel at one position each and share shading (kHybridMultisample): that of up to kSharedColors
// triangles. One picture a triangle: its name as in kBindVisibility, and kBindSeen and kBindSignals of the frame that
// shaded it.
GPU_CONSTANT uint kBindColorIds = 82u;     // storage uvec2[]
GPU_CONSTANT uint kBindColorSeen = 83u;    // storage vec4[]
GPU_CONSTANT uint kBindColorSignals = 84u; // storage vec4[]
// Consecutive frames see parts of each pixel (kHybridFractions), one picture for each of kFractions. Storage float[]:
// the fraction of the pixel that the part is. No frame has shared colours as well.
GPU_CONSTANT uint kBindFractions = kBindColorIds;

// ---- hybrid rendering -----------------------------------------------------------------------------------------------
// One frame of a hybrid render: every pixel is seen through the same position of its filter, so that the frame can be
// rasterized.
struct HybridFrame {
  vec2 jitter;         // position in the pixel, from its centre, in pixels: x to the right, y downwards
  float near;          // distance of the near plane along the view axis
  float far;           // distance of the far plane; orthographic cameras only
  vec3 ambient;        // radiance that stands for all light of more than one bounce
  float ao_radius;     // metres from which on nothing occludes; kFar = unlimited
  uint sample_index;   // this frame's, as the film counts
  uint shadow_samples; // light samples a pixel and frame
  uint ao_samples;
  uint flags;           // kHybrid bits
  float ao_bias;        // least angle of horizons above the tangent plane, radians
  float ao_thinness;    // fraction by which what is seen behind a body lowers its horizon; 0: bodies have no back
  uint sample_position; // kHybridMultisample, kHybridFractions: of the frame among those that belong together
  uint first_position;  // first of them from which on colours are kept
  uint film_width; // of the picture, in pixels; gpu::Frame has the frame's own size, which is half of it for upscaling
  uint film_height;
  uint pad0;
  uint pad1;
};
GPU_CHECK(sizeof(HybridFrame) == 80);
GPU_CONSTANT uint kJitters = 1024u;
GPU_CONSTANT uint kHybridLights = 1u << 0;      // direct light is wanted
GPU_CONSTANT uint kHybridAmbient = 1u << 1;     // the ambient term is wanted
GPU_CONSTANT uint kHybridToColor = 1u << 2;     // composite leaves the frame in `seen`, for a filter,
GPU_CONSTANT uint kHybridFromColor = 1u << 3;   // composite reads the frame from `seen`
GPU_CONSTANT uint kHybridLayers = 1u << 4;      // BLEND surfaces are layers in front of the frame, see kBindLayers
GPU_CONSTANT uint kHybridScreendoor = 1u << 5;  // BLEND surfaces have holes in a fixed pattern
GPU_CONSTANT uint kHybridMultisample = 1u << 6; // frames share shading, see kBindColorIds
GPU_CONSTANT uint kHybridRefractive = 1u << 7; // transmitting surfaces are layers, through which the frame is seen bent
GPU_CONSTANT uint kHybridReflections = 1u << 8; // mirrors show lit surfaces, see kBindReflections
GPU_CONSTANT uint kHybridFractions = 1u << 9;   // frames see parts of pixels, see kBindFractions
GPU_CONSTANT uint kSharedColors = 4u;           // triangles of a pixel whose shading frames share
GPU_CONSTANT uint kFractions = 4u;              // parts of a pixel
GPU_CONSTANT float kDemodulationFloor = 0.1f;   // see demodulation()

// First hit of a pixel, as filters need it.
struct GbufferPixel {
  vec3 normal;  // shading normal, world, on the side of the eye
  float depth;  // distance along the view axis, metres; 0 = nothing was seen
  vec3 albedo;  // base colour
  uint surface; // same value = same placed mesh and material: what a filter may mix
};
GPU_CHECK(sizeof(GbufferPixel) == 32);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
