// trace() as ray_kinds.glsl declares it: by our own traversal, or, in builds with RAY_QUERY, by the device's ray
// queries. Include bindings.glsl with BIND_GEOMETRY first.
#ifndef WAVEPATH_TRACE_GLSL
#define WAVEPATH_TRACE_GLSL

#ifdef RAY_QUERY
#include "kernels/bvh/ray_query.glsl"
#else
#include "kernels/bvh/bvh.glsl"
#endif

#endif
