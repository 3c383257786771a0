// Crossing of a body's surface: finds the body behind it, tells whether another body hides the surface, and updates the
// list of bodies that a path is in. Include bindings.glsl with BIND_GEOMETRY, BIND_SURFACES and BIND_PATHS first.
#ifndef WAVEPATH_PATH_CROSSING_GLSL
#define WAVEPATH_PATH_CROSSING_GLSL

#include "kernels/path/bodies.glsl"
#include "kernels/surface/vertex.glsl"

#ifdef LAYERED

// The other bodies at a surface that the path meets.
uvec4 other_bodies(Vertex v, uint slot) {
  uvec4 bodies = fetch_bodies(slot);
  return v.bsdf.entering ? bodies : without_body(bodies, v.surface.material);
}

// The body that the surface of another one borders on, kNone for the open.
uint outside_body(Vertex v, uint slot) {
  if (!is_nested() || v.bsdf.thin) return kNone;
  uint outside = other_bodies(v, slot).x;
  return outside == kNoBody ? kNone : outside;
}

// Sets the vertex's ior relative to the body outside.
void set_outside(inout Vertex v, uint outside) {
  if (!is_nested() || outside == kNone) return;
  Material other = fetch_material(outside);
  if (v.bsdf.ior > 0.0 && other.ior > 0.0) v.bsdf.ior /= other.ior;
}

// True if the surface lies within a body of higher priority, so that the path goes straight on. Otherwise sets the ior
// relative to the body outside.
bool is_hidden(inout Vertex v, uint slot) {
  uint outside = outside_body(v, slot);
  if (outside == kNone) return false;
  if (body_priority(outside) >= v.material.flags >> kMaterialPriorityShift) return true;
  set_outside(v, outside);
  return false;
}

// The body behind a surface, for light that passes it.
uint body_behind(Vertex v, uint slot) {
  if (!is_nested() || v.bsdf.entering) return medium_behind(v);
  uint next = other_bodies(v, slot).x;
  return next == kNoBody ? kNone : next;
}

uvec4 bodies_behind(Vertex v, uint slot) {
  if (!is_nested()) return one_body(medium_behind(v));
  return v.bsdf.entering ? with_body(fetch_bodies(slot), v.surface.material) : other_bodies(v, slot);
}

// Updates the list after the path has passed the surface.
void cross_surface(Vertex v, uint slot) {
  if (!is_nested()) path_media[slot] = medium_behind(v);
  else store_bodies(slot, bodies_behind(v, slot));
}

#else // bodies do not overlap

bool is_hidden(inout Vertex v, uint slot) { return false; }
uint outside_body(Vertex v, uint slot) { return kNone; }
void set_outside(inout Vertex v, uint outside) {}
uint body_behind(Vertex v, uint slot) { return medium_behind(v); }
uvec4 bodies_behind(Vertex v, uint slot) { return one_body(medium_behind(v)); }
void cross_surface(Vertex v, uint slot) { path_media[slot] = medium_behind(v); }

#endif
#endif
