// Places the corners of the triangles that lie in none of the scene's large planes in a light's view.
#version 460
#extension GL_GOOGLE_include_directive : require

#define BIND_RECEIVER_PLANES
#include "kernels/hybrid/shadows/shadow_vertex.glsl"
