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
  std::vector<Binding> layout = reflection_layout();
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
  reserve(device, ids_, std::uint64_t{settings.width} * settings.height * sizeof(glm::uvec2));
  RayReflections::change(view, settings, config, shared);
  if (is_new) target_.reset();
  pictures_.clear();
  using enum BindingKind;
  std::vector<Binding> drawn = context_.workspace.on_device->bindings();
  for (const Binding& binding : shared)
    if (binding.slot == gpu::kBindHybrid || binding.slot == gpu::kBindVisibility) drawn.push_back(binding);
  drawn.push_back({gpu::kBindReflectionFrame, uniform, &frame_buffer()});
  drawn.push_back({gpu::kBindEntries, texels_r32ui, &unused_});
  for (std::size_t i = 0; i < planes_.size(); ++i) pictures_.push_back(std::make_unique<Picture>(device, drawn));
  if (is_new && planes_.empty()) {
    const std::vector<glm::uvec2> none(std::size_t{settings.width} * settings.height, {gpu::kNone, gpu::kNoMirror});
    ids_.write(none.data(), none.size() * sizeof(none[0]));
  } else if (is_new) {
    make_target(settings.width, settings.height, specialization(config, device.info()));
  }
  made_for_ = made_for;
}

PicturedReflections::Picture::Picture(Device& device, std::vector<Binding> own)
    : frame(device, sizeof(gpu::Frame)),
      bindings(device, with(std::move(own), {gpu::kBindFrame, BindingKind::uniform, &frame}), sizeof(gpu::Wave),
               BindingSet::kRasterStages) {}

// Normals point to the side that the eye is on.
void PicturedReflections::turn_to_eye() {
  const gpu::Frame& frame = context_.workspace.frame;
  const glm::dvec3 eye(frame.camera_position), forward(frame.camera_forward);
  std::ranges::fill(frame_.mirrors, glm::vec4(0.0f));
  frame_.tolerance = static_cast<float>(mirror_tolerance(context_.workspace.scene));
  for (std::size_t i = 0; i < planes_.size(); ++i) {
    MirrorPlane& plane = planes_[i];
    const double side =
        frame.orthographic ? -glm::dot(plane.normal, forward) : glm::dot(plane.normal, eye) + plane.offset;
    if (side < 0.0) plane.normal = -plane.normal, plane.offset = -plane.offset;
    frame_.mirrors[i] = glm::vec4(plane.normal, plane.offset);
  }
}

std::uint64_t PicturedReflections::bytes() const {
  return RayReflections::bytes() + ids_.bytes() + (target_ ? target_->bytes() : 0);
}

void PicturedReflections::find(Commands& commands, std::size_t band, const gpu::Wave& wave) {
  commands.bind(bindings(band));
  const std::uint32_t slots = groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count);
  commands.dispatch(kernels()[kPictured], slots, &wave);
}

void PicturedReflections::add_bindings(std::vector<Binding>& bindings) {
  bindings.push_back({gpu::kBindMirrorIds, BindingKind::storage, &ids_});
}

void PicturedReflections::draw(WaveQueue& queue, std::uint32_t mirror, const RasterPipeline& pipeline,
                               std::uint32_t clear, const std::function<void(Commands&)>& before,
                               const std::function<void(Commands&)>& after) {
  const Picture& picture = *pictures_[mirror];
  gpu::Frame frame = context_.workspace.frame;
  mirror_camera(planes_[mirror], frame);
  gpu::Wave wave{};
  wave.first_sample = mirror;
  wave.bounce = gpu::kMirroredBounce;
  const SlicedPass pass{.target = target_.get(),
                        .pipeline = &pipeline,
                        .bindings = &picture.bindings,
                        .push = &wave,
                        .stage = kMirrorStage,
                        .clear = clear};
  const std::vector<Draw> draws = visible_draws(chunks_, view_of(frame), frame.width, frame.height);
  const auto prepare = [&](Commands& commands) {
    before(commands);
    commands.write(picture.frame, &frame, sizeof(frame));
  };
  draw_in_slices(queue, pass, draws, triangles_a_slice_.next_frame(), prepare, after,
                 [this](double seconds) { triangles_a_slice_.note(seconds); });
}

} // namespace wavepath
