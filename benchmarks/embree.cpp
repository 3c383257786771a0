#include "benchmarks/embree.h"

#include <algorithm>
#include <limits>

#include <embree3/rtcore.h>
#include <tbb/parallel_for.h>

#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/scene/pack/flatten.h"

namespace wavepath {
namespace {

constexpr std::size_t kGrain = 256; // rays a task

template <class Ray>
RTCRay to_embree(const Ray& ray) {
  RTCRay r{};
  r.org_x = ray.origin.x, r.org_y = ray.origin.y, r.org_z = ray.origin.z;
  r.dir_x = ray.direction.x, r.dir_y = ray.direction.y, r.dir_z = ray.direction.z;
  r.tfar = ray.t_max;
  r.mask = ~0u;
  return r;
}

} // namespace

struct EmbreeScene::Handles {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
};

EmbreeScene::EmbreeScene(const PackedScene& scene, bool robust) : handles_(std::make_unique<Handles>()) {
  const std::vector<glm::vec3> corners = flatten(scene);
  handles_->device = rtcNewDevice(nullptr);
  handles_->scene = rtcNewScene(handles_->device);
  rtcSetSceneFlags(handles_->scene, robust ? RTC_SCENE_FLAG_ROBUST : RTC_SCENE_FLAG_NONE);
  rtcSetSceneBuildQuality(handles_->scene, RTC_BUILD_QUALITY_MEDIUM);
  RTCGeometry mesh = rtcNewGeometry(handles_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
  void* vertices =
      rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(glm::vec3), corners.size());
  void* indices = rtcSetNewGeometryBuffer(mesh, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12, corners.size() / 3);
  if (!corners.empty() && (!vertices || !indices))
    throw Error("embree", "has no memory for the scene", "bench a smaller scene");
  std::copy(corners.begin(), corners.end(), static_cast<glm::vec3*>(vertices));
  for (std::uint32_t i = 0; i < corners.size(); ++i) static_cast<std::uint32_t*>(indices)[i] = i;
  rtcCommitGeometry(mesh);
  rtcAttachGeometry(handles_->scene, mesh);
  rtcReleaseGeometry(mesh);
  const auto start = Clock::now();
  rtcCommitScene(handles_->scene);
  build_seconds_ = seconds_since(start);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(handles_->scene);
  rtcReleaseDevice(handles_->device);
}

double EmbreeScene::intersect(std::span<const gpu::Ray> rays, std::vector<float>* t) const {
  if (t) t->assign(rays.size(), std::numeric_limits<float>::infinity());
  const auto start = Clock::now();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.size(), kGrain), [&](const auto& range) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      RTCRayHit hit{to_embree(rays[i]), {}};
      hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
      rtcIntersect1(handles_->scene, &context, &hit);
      if (t && hit.hit.geomID != RTC_INVALID_GEOMETRY_ID) (*t)[i] = hit.ray.tfar;
    }
  });
  return seconds_since(start);
}

double EmbreeScene::occluded(std::span<const gpu::ShadowRay> rays, std::vector<bool>* blocked) const {
  std::vector<std::uint8_t> found(rays.size(), 0);
  const auto start = Clock::now();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, rays.size(), kGrain), [&](const auto& range) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    for (std::size_t i = range.begin(); i < range.end(); ++i) {
      RTCRay ray = to_embree(rays[i]);
      rtcOccluded1(handles_->scene, &context, &ray);
      found[i] = ray.tfar < 0.0f;
    }
  });
  const double seconds = seconds_since(start);
  if (blocked) blocked->assign(found.begin(), found.end());
  return seconds;
}

} // namespace wavepath
