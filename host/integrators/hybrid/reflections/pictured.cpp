#include "host/integrators/hybrid/reflections/pictured.h"

#include <algorithm>
#include <cmath>

#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/reflections/mirrored_frag.spv.h"
#include "kernels/hybrid/visibility_vert.spv.h"

namespace wavepath {
namespace {

constexpr const char* kMirrorStage = "mirrors";
constexpr std::uint64_t kFirstTriangles = 1u << 14; // of a slice: a guess

glm::vec3 mirrored_vector(const MirrorPlane& plane, const glm::dvec3& v) {
  return glm::vec3(v - 2.0 * glm::dot(plane.normal, v) * plane.normal);
}

// The camera behind the plane, whose picture lies over the frame's as the mirror shows it.
void mirror_camera(const MirrorPlane& plane, gpu::Frame& frame) {
  const glm::dvec3 eye(frame.camera_position);
  frame.camera_position = glm::vec3(eye - 2.0 * (glm::dot(plane.normal, eye) + plane.offset) * plane.normal);
  frame.camera_right = mirrored_vector(plane, glm::dvec3(frame.camera_right));
  frame.camera_up = mirrored_vector(plane, glm::dvec3(frame.camera_up));
  frame.camera_forward = mirrored_vector(plane, glm::dvec3(frame.camera_forward));
}

// The same plane, whose normal points to the side that the camera is on.
MirrorPlane turned_to(const gpu::Frame& frame, MirrorPlane plane) {
  const glm::dvec3 eye(frame.camera_position), forward(frame.camera_forward);
  const double side =
      frame.orthographic ? -glm::dot(plane.normal, forward) : glm::dot(plane.normal, eye) + plane.offset;
  if (side < 0.0) plane.normal = -plane.normal, plane.offset = -plane.offset;
  return plane;
}

std::vector<Binding> with(std::vector<Binding> bindings, const Binding& more) {
  bindings.push_back(more);
  return bindings;
}

gpu::CameraView view_of(const gpu::Frame& frame) {
  gpu::CameraView camera{};
  camera.position = frame.camera_position;
  camera.orthographic = frame.orthographic;
  camera.right = frame.camera_right;
  camera.up = frame.camera_up;
  camera.forward = frame.camera_forward;
  return camera;
}

} // namespace

const RasterCode kMirroredCode{"mirrors", wavepath_visibility_vert_spv, wavepath_mirrored_frag_spv};

std::vector<Binding> pictured_layout() {
  std::vector<Binding> layout = ray_layout();
  layout.push_back({gpu::kBindMirrorIds, BindingKind::storage, nullptr});
  return layout;
}

PicturedReflections::PicturedReflections(const ReflectionContext& context)
    : RayReflections(context),
      chunks_(make_chunks(context.workspace.scene)),
      triangles_a_slice_(kFirstTriangles),
      unused_(context.workspace.device, 0) {}

void PicturedReflections::change(const View& view, const RenderPlan& settings, const KernelConfig& config,
                                 const std::vector<Binding>& shared) {
  Device& device = context_.workspace.device;
  const MadeFor made_for{settings.width, settings.height, settings.reflection_threshold, config};
  const bool is_new = made_for != made_for_;
  if (is_new) planes_ = mirror_planes(context_.workspace.scene, settings.reflection_threshold);
  turn_to_eye();
  pairs_.clear();
  if (reflection_depth(context_.kind, settings) > 1) find_pairs();
  const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
  reserve(device, ids_, (pairs_.empty() ? 1 : 2) * pixels * sizeof(glm::uvec2));
  RayReflections::change(view, settings, config, shared);
  if (is_new) target_.reset();
  make_pictures(shared);
  if (is_new && planes_.empty()) {
    const std::vector<glm::uvec2> none(pixels, {gpu::kNone, gpu::kNoMirror});
    ids_.write(none.data(), none.size() * sizeof(none[0]));
  } else if (is_new) {
    make_target(settings.width, settings.height, specialization(config, device.info()));
  }
  made_for_ = made_for;
}

// Marks of mirrors in mirrors read what the first mirrors show as other marks read what the frame shows.
void PicturedReflections::make_pictures(const std::vector<Binding>& shared) {
  using enum BindingKind;
  Device& device = context_.workspace.device;
  std::vector<Binding> drawn = context_.workspace.on_device->bindings();
  drawn.push_back({gpu::kBindReflectionFrame, uniform, &frame_buffer()});
  drawn.push_back({gpu::kBindEntries, texels_r32ui, &unused_});
  Binding visible{};
  for (const Binding& binding : shared) {
    if (binding.slot == gpu::kBindHybrid) drawn.push_back(binding);
    if (binding.slot == gpu::kBindVisibility) visible = binding;
  }
  pictures_.clear();
  for (std::uint32_t i = 0; i < mirror_count(); ++i)
    pictures_.push_back(std::make_unique<Picture>(device, with(drawn, visible), i, gpu::kNone));
  visible.buffer = &ids_;
  for (const Pair& pair : pairs_)
    pictures_.push_back(std::make_unique<Picture>(device, with(drawn, visible), pair.second, pair.first));
}

PicturedReflections::Picture::Picture(Device& device, std::vector<Binding> own, std::uint32_t its_mirror,
                                      std::uint32_t its_first)
    : mirror(its_mirror),
      first(its_first),
      frame(device, sizeof(gpu::Frame)),
      bindings(device, with(std::move(own), {gpu::kBindFrame, BindingKind::uniform, &frame}), sizeof(gpu::Wave),
               BindingSet::kRasterStages) {}

// Normals point to the side that the eye is on.
void PicturedReflections::turn_to_eye() {
  std::ranges::fill(frame_.mirrors, glm::vec4(0.0f));
  frame_.tolerance = static_cast<float>(mirror_tolerance(context_.workspace.scene));
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    planes_[i] = turned_to(context_.workspace.frame, planes_[i]);
    frame_.mirrors[i] = glm::vec4(planes_[i].normal, planes_[i].offset);
  }
}

// A ray leaves the first mirror to the side of the eye. It meets the second one on the side of the mirrored eye, which
// the first mirror lies on.
void PicturedReflections::find_pairs() {
  const double tolerance = mirror_tolerance(context_.workspace.scene);
  for (std::uint32_t i = 0; i < mirror_count(); ++i) {
    gpu::Frame mirrored = context_.workspace.frame;
    mirror_camera(planes_[i], mirrored);
    for (std::uint32_t j = 0; j < mirror_count(); ++j) {
      const MirrorPlane second = turned_to(mirrored, planes_[j]);
      if (i == j || !reaches_in_front(second, planes_[i], tolerance) ||
          !reaches_in_front(planes_[i], second, tolerance))
        continue;
      frame_.mirrors[mirror_count() + pairs_.size()] = glm::vec4(second.normal, second.offset);
      pairs_.push_back({i, j});
    }
  }
}

bool PicturedReflections::sees_nested(const RenderPlan&) { return !pairs_.empty(); }

std::uint64_t PicturedReflections::bytes() const {
  return RayReflections::bytes() + ids_.bytes() + (target_ ? target_->bytes() : 0);
}

void PicturedReflections::find(Commands& commands, std::size_t band, const gpu::Wave& wave, std::uint32_t depth) {
  commands.bind(bindings(band));
  const std::uint32_t slots = groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count);
  gpu::Wave pictured = wave;
  pictured.bounce = depth;
  commands.dispatch(kernels()[kPictured], slots, &pictured);
}

void PicturedReflections::add_bindings(std::vector<Binding>& bindings) {
  RayReflections::add_bindings(bindings);
  bindings.push_back({gpu::kBindMirrorIds, BindingKind::storage, &ids_});
}

gpu::Frame PicturedReflections::seen_by(const Picture& picture) const {
  gpu::Frame frame = context_.workspace.frame;
  if (picture.is_nested()) mirror_camera(planes_[picture.first], frame);
  return frame;
}

void PicturedReflections::draw(WaveQueue& queue, std::uint32_t index, const RasterPipeline& pipeline,
                               std::uint32_t clear, const std::function<void(Commands&)>& before,
                               const std::function<void(Commands&)>& after) {
  const Picture& drawn = picture(index);
  gpu::Frame frame = seen_by(drawn);
  mirror_camera(planes_[drawn.mirror], frame);
  gpu::Wave wave{};
  wave.first_sample = index;
  wave.bounce = gpu::kMirroredBounce;
  const SlicedPass pass{.target = target_.get(),
                        .pipeline = &pipeline,
                        .bindings = &drawn.bindings,
                        .push = &wave,
                        .stage = kMirrorStage,
                        .clear = clear};
  const std::vector<Draw> draws = visible_draws(chunks_, view_of(frame), frame.width, frame.height);
  const auto prepare = [&](Commands& commands) {
    before(commands);
    commands.write(drawn.frame, &frame, sizeof(frame));
  };
  draw_in_slices(queue, pass, draws, triangles_a_slice_.next_frame(), prepare, after,
                 [this](double seconds) { triangles_a_slice_.note(seconds); });
}

} // namespace wavepath
