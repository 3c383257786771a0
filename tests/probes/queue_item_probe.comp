// The entry of a queue that each invocation takes.
#version 460
#extension GL_GOOGLE_include_directive : require
#include "kernels/path/queue_item.glsl"

layout(local_size_x = kWorkgroupSize) in;
layout(set = 0, binding = 0, std430) writeonly buffer Places { uint places[]; };

void main() { places[gl_GlobalInvocationID.x] = queue_item(); }
