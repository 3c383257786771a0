// Places the corners of every triangle in a light's view.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "kernels/hybrid/shadows/shadow_vertex.glsl"
