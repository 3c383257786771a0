// The types of all structs and constants that host and kernels share: compiled by C++ and by GLSL.
//
// Layout rule: vec3 is always followed by a scalar, vec4 starts at a multiple of 16, so that the offsets of std430,
// std140 and C++ coincide; tests/layout_test.cpp compares them with what SPIR-V says.
// Spaces: "world" on the device is the scene's world moved so that `Scene::origin` is zero. Units: glTF's (metres,
// radiance).
#ifndef WAVEPATH_GPU_H
#define WAVEPATH_GPU_H

#ifdef __cplusplus
#include <cstdint>
#include <glm/glm.hpp>
#define GPU_CONSTANT inline constexpr
#define GPU_FUNCTION inline
#define GPU_CHECK(condition) static_assert(condition)
namespace wavepath::gpu {
using uint = std::uint32_t;
using glm::ivec3;
using glm::uvec2;
using glm::uvec3;
using glm::vec2;
using glm::vec3;
using glm::vec4;
#else
#define GPU_CONSTANT const
#define GPU_FUNCTION
#define GPU_CHECK(condition)
#endif

GPU_CONSTANT uint kNone = 0xffffffffu;
GPU_CONSTANT uint kWorkgroupSize = 64u;
GPU_CONSTANT float kFar = 3.402823466e38f; // t_max of a ray that nothing bounds

#ifdef __cplusplus
} // namespace wavepath::gpu
#endif
#endif
