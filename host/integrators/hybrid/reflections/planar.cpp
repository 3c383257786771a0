// Plane mirrors by pictures of the mirrored scene (Diefenbach and Badler 1997): for each plane, the scene is rasterized
// by a camera behind it, and cut off at the plane. What is seen in other mirrors is missed.
#include <algorithm>
#include <array>
#include <memory>

#include "host/gpu/raster.h"
#include "host/integrators/hybrid/raster/culling.h"
#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/reflections/kinds.h"
#include "host/integrators/hybrid/reflections/mirror_planes.h"
#include "host/integrators/hybrid/reflections/rays.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/reflections/mirror_pick.spv.h"
#include "kernels/hybrid/reflections/mirrored_frag.spv.h"
#include "kernels/hybrid/reflections/reflect.spv.h"
#include "kernels/hybrid/reflections/reflect_answer.spv.h"
#include "kernels/hybrid/reflections/reflect_meet.spv.h"
#include "kernels/hybrid/reflections/reflect_pictured.spv.h"
#include "kernels/hybrid/visibility_vert.spv.h"

namespace wavepath {
namespace {

enum PlanarStage : std::size_t { kPictured = kRayStageCount, kPick, kPlanarStageCount };
const std::array<KernelCode, kPlanarStageCount> kPlanarStages = {
    {{"reflect", wavepath_reflect_spv},
     {"meet reflected", wavepath_reflect_meet_spv},
     {"answer reflected", wavepath_reflect_answer_spv},
     {"pictured reflections", wavepath_reflect_pictured_spv},
     {"pick mirrors", wavepath_mirror_pick_spv}}};
constexpr std::array<std::size_t, kPlanarStageCount> kPlanarOrder = {kReflect, kMeet, kPick, kPictured, kAnswer};

std::vector<Binding> planar_layout() {
  std::vector<Binding> layout = reflection_layout();
  layout.push_back({gpu::kBindMirrorPicture, BindingKind::texels_rg32ui, nullptr});
  layout.push_back({gpu::kBindMirrorIds, BindingKind::storage, nullptr});
  return layout;
}
const KernelProgram kPlanarReflectionProgram = {kPlanarStages, kPlanarOrder, planar_layout};

constexpr const char* kMirrorStage = "mirrors";
constexpr std::uint64_t kFirstTriangles = 1u << 14; // of a slice: a guess
constexpr std::uint32_t kPickedPixels = 1u << 16;   // of a dispatch
const RasterCode kMirroredCode{"mirrors", wavepath_visibility_vert_spv, wavepath_mirrored_frag_spv};
constexpr std::array<AttachmentInfo, 2> kMirroredAttachments{
    {{.name = "mirror", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNone}}},
     {.name = "depth", .format = ImageFormat::depth32f, .clear = {.depth = 0.0f}}}};

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

gpu::CameraView view_of(const gpu::Frame& frame) {
  gpu::CameraView camera{};
  camera.position = frame.camera_position;
  camera.orthographic = frame.orthographic;
  camera.right = frame.camera_right;
  camera.up = frame.camera_up;
  camera.forward = frame.camera_forward;
  return camera;
}

// Draws what one mirror shows.
struct MirrorPicture {
  MirrorPicture(Workspace& workspace, const Buffer& hybrid, const Buffer& reflection)
      : frame(workspace.device, sizeof(gpu::Frame)),
        unused(workspace.device, 0),
        bindings(workspace.device, bindings_of(workspace, hybrid, reflection), sizeof(gpu::Wave),
                 BindingSet::kRasterStages) {}

  std::vector<Binding> bindings_of(const Workspace& workspace, const Buffer& hybrid, const Buffer& reflection) const {
    using enum BindingKind;
    std::vector<Binding> own = workspace.on_device->bindings();
    own.insert(own.end(), {{gpu::kBindFrame, uniform, &frame},
                           {gpu::kBindHybrid, uniform, &hybrid},
                           {gpu::kBindReflectionFrame, uniform, &reflection},
                           {gpu::kBindEntries, texels_r32ui, &unused}});
    return own;
  }

  Buffer frame, unused; // the frame's constants, with the mirrored camera
  BindingSet bindings;
};

class PlanarReflections : public RayReflections {
public:
  explicit PlanarReflections(const ReflectionContext& context)
      : RayReflections(context), chunks_(make_chunks(context.workspace.scene)), triangles_a_slice_(kFirstTriangles) {}

  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override {
    Device& device = context_.workspace.device;
    const MadeFor made_for{settings.width, settings.height, settings.reflection_threshold, config};
    const bool is_new = made_for != made_for_;
    if (is_new) planes_ = mirror_planes(context_.workspace.scene, settings.reflection_threshold);
    turn_to_eye();
    const std::uint64_t pixels = std::uint64_t{settings.width} * settings.height;
    reserve(device, picture_, pixels * sizeof(glm::uvec2));
    reserve(device, ids_, pixels * sizeof(glm::uvec2));
    RayReflections::change(view, settings, config, shared);
    if (is_new) make_pictures(settings, config, *std::ranges::find(shared, gpu::kBindHybrid, &Binding::slot)->buffer);
    made_for_ = made_for;
  }

  void build(WaveQueue& queue) override {
    for (std::uint32_t i = 0; i < pictures_.size(); ++i) draw(queue, i);
    if (pictures_.empty()) // a mirror of no plane, which no pixel shows
      queue.submit([this](Commands& commands) { pick(commands, 0); }, {.stage = kMirrorStage});
  }

  std::uint64_t bytes() const override {
    return RayReflections::bytes() + picture_.bytes() + ids_.bytes() + (target_ ? target_->bytes() : 0);
  }
  ReflectionReport report() const override { return Reflections::report(); }

protected:
  void find(Commands& commands, std::size_t band, const gpu::Wave& wave) override {
    commands.bind(bindings(band));
    const std::uint32_t slots = groups_for(std::uint64_t{wave.pixel_count} * wave.sample_count);
    commands.dispatch(kernels()[kPictured], slots, &wave);
  }
  std::uint32_t mirrors() const override { return gpu::kMirrorsIdeal; }
  void add_bindings(std::vector<Binding>& bindings) override {
    bindings.push_back({gpu::kBindMirrorPicture, BindingKind::texels_rg32ui, &picture_});
    bindings.push_back({gpu::kBindMirrorIds, BindingKind::storage, &ids_});
  }

private:
  struct MadeFor {
    std::uint32_t width = 0, height = 0;
    double threshold = 0.0;
    KernelConfig config;
    bool operator==(const MadeFor&) const = default;
  };

  // Normals point to the side that the eye is on.
  void turn_to_eye() {
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

  void make_pictures(const RenderPlan& settings, const KernelConfig& config, const Buffer& hybrid) {
    Device& device = context_.workspace.device;
    pipeline_.reset();
    pictures_.clear();
    target_.reset();
    for (std::size_t i = 0; i < planes_.size(); ++i)
      pictures_.push_back(std::make_unique<MirrorPicture>(context_.workspace, hybrid, frame_buffer()));
    if (pictures_.empty()) return;
    target_ = std::make_unique<RasterTarget>(device, settings.width, settings.height, kMirroredAttachments);
    pipeline_ = std::make_unique<RasterPipeline>(device, kMirroredCode, kMirroredAttachments, RasterState{},
                                                 pictures_.front()->bindings, specialization(config, device.info()));
  }

  void draw(WaveQueue& queue, std::uint32_t mirror) {
    const MirrorPicture& picture = *pictures_[mirror];
    gpu::Frame frame = context_.workspace.frame;
    mirror_camera(planes_[mirror], frame);
    gpu::Wave wave{};
    wave.first_sample = mirror;
    wave.bounce = gpu::kMirroredBounce;
    const SlicedPass pass{.target = target_.get(),
                          .pipeline = pipeline_.get(),
                          .bindings = &picture.bindings,
                          .push = &wave,
                          .stage = kMirrorStage};
    const std::vector<Draw> draws = visible_draws(chunks_, view_of(frame), frame.width, frame.height);
    const auto prepare = [&](Commands& commands) { commands.write(picture.frame, &frame, sizeof(frame)); };
    draw_in_slices(
        queue, pass, draws, triangles_a_slice_.next_frame(), prepare,
        [&](Commands& commands) {
          target_->image(0).copy_to(commands.handle(), picture_);
          commands.barrier();
          pick(commands, mirror);
        },
        [this](double seconds) { triangles_a_slice_.note(seconds); });
  }

  void pick(Commands& commands, std::uint32_t mirror) {
    commands.bind(bindings(0));
    const std::uint32_t pixels = context_.workspace.frame.width * context_.workspace.frame.height;
    for (std::uint32_t first = 0; first < pixels; first += kPickedPixels) {
      gpu::Wave wave{};
      wave.first_sample = mirror;
      wave.first_pixel = first;
      wave.pixel_count = std::min(kPickedPixels, pixels - first);
      commands.dispatch(kernels()[kPick], groups_for(wave.pixel_count), &wave);
    }
  }

  std::vector<Chunk> chunks_;
  SliceLength triangles_a_slice_;
  MadeFor made_for_;
  std::vector<MirrorPlane> planes_;
  std::vector<std::unique_ptr<MirrorPicture>> pictures_; // of each plane
  std::unique_ptr<RasterTarget> target_;                 // of all pictures in turn; null if there are none
  std::unique_ptr<RasterPipeline> pipeline_;
  Buffer picture_, ids_;
};

} // namespace

constinit const ReflectionKind kReflectionPlanar = {
    .name = "planar",
    .summary = "drawn by mirrored cameras, of plane mirrors alone (Diefenbach and Badler 1997)",
    .program = &kPlanarReflectionProgram,
    .make = [](const ReflectionContext& context) -> std::unique_ptr<ReflectionTechnique> {
      return std::make_unique<PlanarReflections>(context);
    },
};

} // namespace wavepath
