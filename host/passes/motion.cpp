#include "host/passes/motion.h"

#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "host/scene/pack/hit_surface.h"

namespace wavepath {
namespace {

// Of instances that one node shows, the same number stands for the same one; where a pose has lost some of them, as
// those without area are left out, none is known.
std::vector<std::uint32_t> match_instances(const SurfacePose& here, const SurfacePose& other) {
  std::map<std::uint32_t, std::vector<std::uint32_t>> of_node;
  for (std::uint32_t i = 0; i < other.instances.size(); ++i) of_node[other.instances[i].node].push_back(i);
  std::map<std::uint32_t, std::uint32_t> count, next;
  for (const Instance& instance : here.instances) ++count[instance.node];
  std::vector<std::uint32_t> match;
  for (const Instance& instance : here.instances) {
    const std::vector<std::uint32_t>& known = of_node[instance.node];
    const std::uint32_t number = next[instance.node]++;
    match.push_back(known.size() == count[instance.node] ? known[number] : kNoIndex);
  }
  return match;
}

// Corners of a triangle of the pose in world space.
glm::dmat3 corners_of(const SurfacePose& pose, std::uint32_t instance, const std::uint32_t* vertices) {
  const Instance& placed = pose.instances[instance];
  const std::vector<glm::vec3>& positions = pose.positions[placed.mesh];
  glm::dmat3 corners;
  for (int k = 0; k < 3; ++k)
    corners[k] = glm::dvec3(placed.world_from_object * glm::dvec4(glm::dvec3(positions[vertices[k]]), 1.0));
  return corners;
}

// Barycentric weights of the point of a triangle's plane that is nearest to `point`.
glm::dvec3 weights_of(const glm::dmat3& corners, const glm::dvec3& point) {
  const glm::dvec3 a = corners[1] - corners[0], b = corners[2] - corners[0], p = point - corners[0];
  const double aa = glm::dot(a, a), ab = glm::dot(a, b), bb = glm::dot(b, b), pa = glm::dot(p, a), pb = glm::dot(p, b);
  const double area = aa * bb - ab * ab;
  const double u = (bb * pa - ab * pb) / area, v = (aa * pb - ab * pa) / area;
  return {1.0 - u - v, u, v};
}

// Position in the other pose of the surface at `point`. False if that has no such surface.
bool follow(const OtherPicture& other, const MotionPictures& pictures, const PackedScene& scene, const gpu::Hit& hit,
            glm::dvec3& point) {
  const SourceTriangle& source = scene.sources[hit.triangle];
  const std::uint32_t id = scene.root_is_top ? scene.instances[hit.instance].id : kNoIndex;
  const bool is_shared = id != kNoIndex && id != scene.once_instance;
  const std::uint32_t instance = is_shared ? scene.instance_sources[id] : pictures.instance_of[source.mesh];
  const std::uint32_t there = other.instance_of[instance];
  if (there == kNoIndex) return false;
  const std::vector<glm::vec3>& moved = other.pose->positions[other.pose->instances[there].mesh];
  if (moved.size() != pictures.here.positions[source.mesh].size()) return false;
  const std::uint32_t* vertices = &pictures.indices[source.mesh][source.first_index];
  const glm::dmat3 before = corners_of(pictures.here, instance, vertices);
  // The difference, so that what stays has no motion at all.
  point += (corners_of(*other.pose, there, vertices) - before) * weights_of(before, point);
  return true;
}

} // namespace

SurfacePose pose_of(const Scene& scene) {
  SurfacePose pose;
  for (const Mesh& mesh : scene.meshes) pose.positions.push_back(mesh.positions);
  pose.instances = scene.instances;
  return pose;
}

void set_pose_here(const Scene& scene, MotionPictures& pictures) {
  pictures.here = pose_of(scene);
  pictures.indices.clear();
  for (const Mesh& mesh : scene.meshes) pictures.indices.push_back(mesh.indices);
  pictures.instance_of.assign(scene.meshes.size(), kNoIndex);
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i) pictures.instance_of[scene.instances[i].mesh] = i;
  for (std::optional<OtherPicture>* other : {&pictures.next, &pictures.previous})
    if (*other && (*other)->pose) (*other)->instance_of = match_instances(pictures.here, *(*other)->pose);
}

glm::dvec2 motion_to(const OtherPicture& other, const MotionPictures& pictures, const PackedScene& scene,
                     const View& view, const glm::uvec2& size, const FirstHit& found) {
  const glm::dvec2 nowhere(std::numeric_limits<double>::quiet_NaN());
  const bool pair = view.eye_distance != 0.0, stacked = pair && stacks_eyes(view.panorama);
  const glm::uvec2 pixel{found.pixel % size.x, found.pixel / size.x};
  const glm::uvec2 eye_size{pair && !stacked ? size.x / 2 : size.x, stacked ? size.y / 2 : size.y};
  const int eye = !pair ? 0 : pixel.x >= eye_size.x || pixel.y >= eye_size.y ? 1 : -1;
  const bool is_hit = found.hit.triangle != gpu::kNone;
  const glm::dvec4 from = is_hit ? glm::dvec4(scene.origin + hit_position(scene, found.hit), 1.0)
                                 : glm::dvec4(glm::dvec3(found.ray.direction), 0.0);
  glm::dvec3 point(from);
  if (is_hit && other.pose && !follow(other, pictures, scene, found.hit, point)) return nowhere;
  glm::dvec2 here, there;
  if (!project(view, from, eye, here) || !project(other.view, glm::dvec4(point, from.w), eye, there)) return nowhere;
  glm::dvec2 step = there - here;
  if (other.view.panorama == Panorama::sphere) step.x -= 2.0 * std::round(0.5 * step.x);
  return 0.5 * step * glm::dvec2(eye_size) * glm::dvec2(1.0, -1.0);
}

} // namespace wavepath
