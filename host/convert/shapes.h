// Shapes that glTF lacks, as triangles; and what all meshes need before they are written.
#pragma once

#include <cstdint>

#include "host/convert/described.h"

namespace wavepath::convert {

// Of radius 1 about the origin, poles on +Z and -Z; z and phi limit it. Radians. `inner`: of a disk.
Mesh sphere(double z_min = -1.0, double z_max = 1.0, double phi_max = 6.283185307179586);
Mesh cylinder(double phi_max = 6.283185307179586);                 // of radius 1 about Z, from z = 0 to 1
Mesh disk(double inner = 0.0, double phi_max = 6.283185307179586); // of radius 1 in z = 0, faces +Z
Mesh rectangle();                                                  // -1..1 in z = 0, faces +Z
Mesh cube();                                                       // -1..1

// Turns the mesh inside out: winding and normals.
void reverse(Mesh& mesh);
// Winds triangles so that they face where their normals point.
void wind_by_normals(Mesh& mesh);
// Normals of smooth shading, weighted by the angles of the triangles.
void add_normals(Mesh& mesh);
// Leaves out triangles with a vertex that is not finite or twice the same. Returns how many.
std::uint64_t remove_bad_triangles(Mesh& mesh);
double area(const Mesh& mesh, const glm::dmat4& matrix);

// Loop's scheme, `levels` times, then the limit normals are those of smooth shading.
Mesh subdivided(const Mesh& control, int levels);

} // namespace wavepath::convert
