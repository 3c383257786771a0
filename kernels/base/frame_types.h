// Constants and records that all kernels use: the camera and settings of a render, a wave of samples, rays and hits.
#ifndef WAVEPATH_FRAME_TYPES_H
#define WAVEPATH_FRAME_TYPES_H

#include "kernels/base/gpu.h"

#ifdef __cplusplus
namespace wavepath::gpu {
#endif

GPU_CONSTANT uint kBindFrame = 0u;     // uniform Frame
GPU_CONSTANT uint kBindEntries = 19u;  // texels R32UI: entries in the order of waves (kFeatureAdaptive)
GPU_CONSTANT uint kBindCounters = 15u; // storage Counters

// ---- one render -----------------------------------------------------------------------------------------------------
// Constants of a render. Camera rays, with x and y in [-1, 1] across the picture:
//
//     perspective:   origin = camera_position,  direction = camera_forward + x*camera_right + y*camera_up
//     orthographic:  origin = camera_position + x*camera_right + y*camera_up,  direction = camera_forward
//
//         pixel (0, 0)                          The picture as the eye sees it: o is camera_position + camera_forward
//     y = 1  +-----------+-----------+          (perspective) or camera_position (orthographic).
//            |           ^           |
//            |           | up        |          camera_forward has length 1 and points into the picture.
//            |           |   right   |          camera_right and camera_up are half the width and half the height of
//            |           o---------->|          the picture: at a distance of 1 (perspective), or in metres.
//            |                       |          All three are at right angles; camera_right points along
//            |                       |          camera_forward x camera_up.
//     y = -1 +-----------------------+
//          x = -1                  x = 1        A pixel's centre is at x = 2 (column + 0.5) / width - 1.
//
// Other cameras are in camera_model.glsl: there x and y are counted from elsewhere, or are angles.
//
// A lens moves the origin over its aperture and turns the ray about its point in the plane of focus (camera.glsl).
struct Frame {
  vec3 camera_position;
  uint width;
  vec3 camera_right;
  uint height;
  vec3 camera_up;
  uint max_depth;
  vec3 camera_forward;
  uint seed;
  vec3 environment_radiance;     // constant environment, or the scale of the map
  float environment_probability; // probability that next-event estimation picks the environment
  vec2 environment_rotation;     // cos, sin: direction in the map = rotation about +Y of the world direction
  uint environment_width;
  uint environment_height;
  uint light_count;
  uint root;        // node where traversal starts
  uint root_is_top; // 1: the root is that of the top-level tree, whose leaves hold instances
  uint orthographic;
  uint sample_total;      // samples a pixel that the stratified sampler spreads over
  uint slot_count;        // capacity of one ray queue
  uint scene_features;    // kFeature bits that the scene has data for, whatever the kernels were compiled with
  uint local_light_count; // triangles, points and spots, which come first among the lights
  float light_sum_scale;  // radiance to units of the sums of training (kFeatureTraining)
  uint probes;            // kProbesNone, kProbesPixels or kProbesQuads (error_probes.h)
  uint scene_lobes;       // kLobe bits, likewise
  uint first_layers;      // texel of the first MaterialLayers
  float lens_radius;      // metres, of the circle that holds the aperture (kSpecLens)
  float focus_distance;   // along the view axis, to the plane that is sharp
  uint motion_texel;      // texel of kBindTriangles where the displacements of corners begin (kSpecMotion)
  uint end_normals;       // offset in vertices from a normal to the one when the shutter closes
  // Bodies that contain the eye, packed as in path_media (kFeatureVolume): kernels/path/bodies.glsl.
  uvec2 bodies_at_eye;
  // Width of a pixel's cone in metres: perspective cameras at a distance of 1 m, orthographic ones everywhere; 0 =
  // textures are looked up exactly (kFeatureMips).
  float pixel_spread;
  uint sky_samples;   // directions in which a vertex looks for a sky of one colour (kSpecSky)
  uvec2 top_level;    // device address of the scene's structure for ray queries: low, high
  uint reuses_paths;  // 1: pixels share the paths of their neighbours (kSpecReuse)
  float quad_scale;   // scale of the pixels of a quad about its middle, where pixels may reuse paths
  uint camera_model;  // kCameraPlain or another (kFeatureCameraModel), which the members below belong to
  uint eyes;          // kEyesOne, kEyesBeside or kEyesStacked
  vec2 camera_shift;  // added to x and y
  float clip_near;    // camera rays begin here: along the view axis, in a panorama from the eye
  float clip_far;     // camera rays end here; kFar = nowhere
  float eye_offset;   // metres from the middle to each eye of a stereo pair
  float angle_limit;  // radians from the axis of a fisheye up to which it sees anything
  uint cover;         // kCover bits of what is asked for (kFeatureCover)
  uint first_catcher; // materials first_catcher <= m < end_catcher are those of the shadow catcher
  uint end_catcher;
  // The part of the picture that the film holds, in pixels (FilmArea); all of it without --crop.
  uint film_left;
  uint film_top;
  uint film_width;
  uint film_height;
  uint pad_film;
  vec3 boost_axis;   // unit direction in which the camera moves through the scene (kFeatureRelativity)
  float boost_scale; // sqrt((1 - v) / (1 + v)) of its speed v in units of that of light; 0 = at rest
};
GPU_CHECK(sizeof(Frame) == 272);

GPU_CONSTANT uint kCameraPlain = 0u, kCameraPlane = 1u, kCameraFisheye = 2u, kCameraSphere = 3u;
GPU_CONSTANT uint kEyesOne = 0u, kEyesBeside = 1u, kEyesStacked = 2u; // the left eye on the left, or on top

// Without error probes, sample s belongs to replicate s % kReplicates. With them, all samples of a pixel belong to
// replicate 0, and probed pixels have as many of replicate 1 (error_probes.h). Replicates are scrambled independently,
// so that their spread measures the error of any sampler.
GPU_CONSTANT uint kReplicates = 2u;

// Levels of an adaptive render: a run of level k gets 2^k times the samples.
GPU_CONSTANT int kLowestLevel = -2, kHighestLevel = 3;
GPU_CONSTANT int kLevels = kHighestLevel - kLowestLevel + 1;

// Push constants: the wave of (pixel, sample) pairs that a dispatch works on. Slot = local sample * pixel_count + local
// pixel; for kernels of an adaptive render (kFeatureAdaptive) wave.h tells it, by levels.
struct Wave {
  // In tile order, probes after all pixels (error_probes.h); where entries are listed, in the order of their list.
  uint first_pixel;
  uint pixel_count;
  uint first_sample;
  uint sample_count;
  uint bounce;           // 0 = camera rays
  uint first_film_pixel; // pixel, in tile order, at the beginning of the film's buffer; for probes, entry minus offset
                         // in the buffer
  uint level_entries[kLevels]; // kFeatureAdaptive: entries of each level, the highest first, that make up pixel_count;
                               // first_sample and sample_count are those of level 0
};

struct Ray {
  vec3 origin;
  uint slot;
  vec3 direction; // unit length
  float t_max;
};
GPU_CHECK(sizeof(Ray) == 32);

GPU_CONSTANT uint kScattered = kNone - 1u;

struct Hit {
  uint triangle; // kNone = miss; kScattered = the volume scattered the path before
  uint instance;
  float b1; // barycentric weight of v1
  float b2;
};
GPU_CHECK(sizeof(Hit) == 16);

// The kernels that can make a sample not finite.
GPU_CONSTANT uint kMakerGenerate = 0u, kMakerShade = 1u, kMakerConnect = 2u; // escape counts as shade
GPU_CONSTANT uint kMakerCount = 3u;

// Counts of the kernels of one wave; the host adds the waves up.
struct Counters {
  uint camera_rays[2]; // 64 bits: low, high
  uint bounce_rays[2];
  uint shadow_rays[2];
  uint occlusion_rays[2];
  uint nonfinite_count[kMakerCount];           // number of non-finite samples, by the kernel that made them
  uint nonfinite_first[kMakerCount * kLevels]; // their lowest slots, by level in an adaptive render (WavePart's rank),
                                               // else that of index 0; kNone if there are none
};
GPU_CHECK(sizeof(Counters) == 116);

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
