#include "host/integrators/hybrid/visibility.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "kernels/base/frame_types.h"
#include "kernels/hybrid/filter_types.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/visibility.spv.h"
#include "kernels/hybrid/visibility_frag.spv.h"
#include "kernels/hybrid/visibility_query.spv.h"
#include "kernels/hybrid/visibility_vert.spv.h"

namespace wavepath {
namespace {

// Guesses, for the first frame.
constexpr std::uint64_t kFirstTriangles = 1 << 16, kFirstPixels = 1 << 15;

std::vector<Binding> visibility_bindings(const DeviceScene& scene, const Buffer& frame, const Buffer& hybrid,
                                         const Buffer& ids, const Buffer& unused) {
  std::vector<Binding> bindings = scene.bindings();
  using enum BindingKind;
  bindings.insert(bindings.end(), {{gpu::kBindFrame, uniform, &frame},
                                   {gpu::kBindHybrid, uniform, &hybrid},
                                   {gpu::kBindVisibility, storage, &ids},
                                   {gpu::kBindEntries, texels_r32ui, &unused}});
  return bindings;
}

// Reversed z: what is nearer has the greater depth, between 1 (near plane) and 0 (infinity). Of equal depths the first
// one drawn stays.
constexpr std::array<AttachmentInfo, 2> kAttachments{
    {{.name = "visibility", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNone}}},
     {.name = "depth", .format = ImageFormat::depth32f, .clear = {.depth = 0.0f}}}};
const KernelCode kTracer{"visibility", wavepath_visibility_spv, {}, wavepath_visibility_query_spv};
const RasterCode kCode{"visibility", wavepath_visibility_vert_spv, wavepath_visibility_frag_spv};

constexpr std::uint64_t kPixelBytes = 2 * sizeof(std::uint32_t);

std::uint64_t ids_bytes(const Device& device, std::uint32_t width, std::uint32_t height) {
  const std::uint64_t pixels = std::uint64_t{width} * height;
  // The G-buffer, which a filter reads as two texels a pixel, is the largest buffer that a frame needs.
  const std::uint64_t most =
      std::min(device.info().max_texels(16) / 2, device.info().max_storage_range / sizeof(gpu::GbufferPixel));
  if (pixels > most)
    throw Error(device.info().name, fmt::format("holds at most {} pixels of a rasterized picture", most),
                "use a smaller --size or --integrator path");
  return pixels * kPixelBytes;
}

} // namespace

gpu::CameraView camera_of(const PackedScene& scene, const View& view) {
  gpu::CameraView camera{};
  camera.position = glm::vec3(view.position - scene.origin);
  camera.orthographic = view.orthographic ? 1u : 0u;
  camera.right = glm::vec3(view.right);
  camera.up = glm::vec3(view.up);
  camera.forward = glm::vec3(view.forward);
  return camera;
}

// Perspective: depth is near / distance, so that a small `near` costs no precision: from 1 down to the smallest normal
// float there are 38 decades. What bounds it from below is clipping: a corner on the near plane is found with an error
// of 2^-24 of the edge that crosses it, and should not come out behind the eye; 1e-6 of the scene's radius is 8 such
// errors of an edge as long as the scene. In scenes of kilometres that would hide what is in front of the lens, so
// there it ends at a hundredth of a millimetre, and edges that cross that plane are as short as things near the eye
// are. Orthographic: `origin` lies in the geometry's box, so nothing is farther from it than two radii.
//
// Planes of --clip lie within these. The far one of a perspective camera is infinite without it.
ClipPlanes clip_planes(const PackedScene& scene, const View& view) {
  const double to_origin = glm::dot(scene.origin - view.position, view.forward);
  const double near = std::clamp(1e-6 * scene.radius, 1e-30, 1e-5);
  const double far = std::max(to_origin, 0.0) + 2.0 * scene.radius;
  ClipPlanes planes{static_cast<float>(near), static_cast<float>(std::max(1.001 * far, 1e-30))};
  if (view.clip == Clip{}) return planes;
  const float clip_near = static_cast<float>(view.clip.near), clip_far = static_cast<float>(view.clip.far);
  planes.near = view.orthographic ? clip_near : std::max(planes.near, clip_near);
  planes.far = view.orthographic ? std::min(planes.far, clip_far) : clip_far;
  planes.far = std::max(planes.far, std::nextafter(planes.near, std::numeric_limits<float>::infinity()));
  return planes;
}

// Clipping to the picture rounds the coordinates of a corner, in units of half the picture, to 2^-24 of what they are
// at the far end of the edge. An orthographic camera can look through a window as small as it likes. In perspective,
// edges go astray only where the eye is 10^4 times closer to a surface than that is large.
bool edges_hold(const PackedScene& scene, const View& view, std::uint32_t width, std::uint32_t height) {
  if (!view.orthographic) return true;
  const double reach = glm::distance(scene.origin, view.position) + 2.0 * scene.radius;
  const double pixels = std::max(0.5 * width / glm::length(view.right), 0.5 * height / glm::length(view.up)) * reach;
  return pixels * 0x1p-24 <= 0.25;
}

Visibility::Visibility(Device& device, const PackedScene& scene, const DeviceScene& gpu_scene, const Buffer& frame,
                       const Buffer& hybrid, gpu::Feature features, std::uint32_t width, std::uint32_t height,
                       bool rasterizes, std::uint32_t cull, bool moves)
    : width_(width),
      height_(height),
      ids_(device, ids_bytes(device, width, height)),
      unused_(device, 0),
      bindings_(device, visibility_bindings(gpu_scene, frame, hybrid, ids_, unused_), sizeof(gpu::Wave),
                rasterizes ? BindingSet::kRasterStages : 0),
      triangles_a_slice_(kFirstTriangles),
      pixels_a_slice_(kFirstPixels) {
  RenderPlan plan(RenderSettings{.cull = cull});
  plan.moving = moves;
  if (moves) plan.kernels.added = gpu::kFeatureSharedFirstHit; // whose moment it is
  const auto constants = specialization(kernel_config(features, scene.stack_size, plan), device.info());
  if (rasterizes)
    raster_.reset(new Raster{{device, width, height, kAttachments},
                             {device, kCode, kAttachments, {}, bindings_, constants},
                             make_chunks(scene)});
  else
    tracer_.emplace(device, kTracer.name, kTracer.build(false, gpu_scene.queries.has_value()), bindings_, constants);
}

void Visibility::render(WaveQueue& queue, const gpu::CameraView& camera, const std::function<void(Commands&)>& prepare,
                        const ShownPart& part) {
  return raster_ ? draw(queue, camera, prepare, part) : trace(queue, prepare);
}

// Copies that spatial splits made of a triangle are drawn as well: they lie in the same plane to the last bit, and the
// first one drawn stays. A depth prepass could only cost: what it would save is a fragment shader that writes two
// words.
void Visibility::draw(WaveQueue& queue, const gpu::CameraView& camera, const std::function<void(Commands&)>& prepare,
                      const ShownPart& part) {
  const gpu::Wave wave{}; // camera rays
  const SlicedPass pass{&raster_->target, &raster_->pipeline, &bindings_, &wave};
  const auto copy = [this](Commands& commands) { raster_->target.image(0).copy_to(commands.handle(), ids_); };
  const std::vector<Draw> draws = visible_draws(raster_->chunks, camera, width_, height_, part);
  draw_in_slices(queue, pass, draws, triangles_a_slice_.next_frame(), prepare, copy,
                 [this](double seconds) { triangles_a_slice_.note(seconds); });
}

void Visibility::trace(WaveQueue& queue, const std::function<void(Commands&)>& prepare) {
  const std::uint64_t most = pixels_a_slice_.next_frame();
  const std::uint32_t pixels = width_ * height_;
  for (std::uint32_t first = 0; first < pixels;) {
    gpu::Wave wave{};
    wave.first_pixel = first;
    wave.pixel_count = static_cast<std::uint32_t>(std::min<std::uint64_t>(most, pixels - first));
    const auto record = [&](Commands& commands) {
      if (first == 0) prepare(commands);
      commands.bind(bindings_);
      commands.dispatch(*tracer_, groups_for(wave.pixel_count), &wave);
    };
    queue.submit(record, {.stage = "raster",
                          .done = [this](const Finished& finished) { pixels_a_slice_.note(finished.seconds); }});
    first += wave.pixel_count;
  }
}

} // namespace wavepath
