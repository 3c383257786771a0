// Prepares a ray for the tests: reciprocals for the slabs, permutation and shear for the triangles.
#include "bvh/intersect.h"

namespace wavepath::bvh {

namespace {

float clamped_inverse(float d) {
  const float magnitude = std::max(std::fabs(d), kMinDirection);
  return 1 / (d < 0 ? -magnitude : magnitude);
}

} // namespace

PreparedRay prepare(const Ray& ray) {
  const Vec3 d = ray.direction;
  const Vec3 size = abs(d);
  int kz = 0;
  if (size.y > size.x) kz = 1;
  if (size.z > size[kz]) kz = 2;
  const int kx = (kz + 1) % 3, ky = (kz + 2) % 3;
  return {ray.origin,
          {clamped_inverse(d.x), clamped_inverse(d.y), clamped_inverse(d.z)},
          kx,
          ky,
          kz,
          d[kx] / d[kz],
          d[ky] / d[kz],
          1 / d[kz],
          ray.t_max,
          in_range(ray.origin) && in_range(d) && ray.t_max > 0};
}

} // namespace wavepath::bvh
