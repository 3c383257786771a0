// The rasterized visibility buffer against traced camera rays: the same triangles, instances and barycentric weights
// wherever no edge passes, and almost everywhere else.
#include "host/integrators/hybrid/visibility.h"
#include "host/integrators/path/paths.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <random>

#include <glm/gtc/matrix_transform.hpp>

#include "host/integrators/path/path_tracer.h"
#include "host/render/workspace/wave_queue.h"
#include "host/render/workspace/workspace.h"
#include "host/scene/gltf/gltf.h"
#include "kernels/base/features.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/tile_order.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/path/extend.spv.h"
#include "kernels/path/path_types.h"
#include "tests/probe.h"
#include "tests/probes/visibility_probe.spv.h"
#include "tests/scene_builder.h"

namespace wavepath::test {
namespace {

const std::filesystem::path kSource = WAVEPATH_SOURCE_DIR;
const std::filesystem::path kShared = kSource / "../shared/scenes";

struct FrameSettings {
  std::uint32_t width = 160, height = 90;
  glm::vec2 jitter{0.31f, -0.42f};
  std::uint32_t sample_index = 3, seed = 7;
};

// What a pixel sees: identities, not places in the buffer, where copies of a triangle may lie.
struct Seen {
  std::uint32_t triangle = gpu::kNone, instance = gpu::kNone;
  bool operator==(const Seen&) const = default;
};

// One frame, both ways; row by row.
struct Shot {
  std::uint32_t width = 0, height = 0;
  std::vector<gpu::Hit> rasterized, traced;
  std::vector<Seen> raster_ids, traced_ids;

  // No edge of what is traced passes within a pixel of this one.
  bool is_interior(std::uint32_t x, std::uint32_t y) const {
    for (std::uint32_t v = y > 0 ? y - 1 : 0; v <= std::min(y + 1, height - 1); ++v)
      for (std::uint32_t u = x > 0 ? x - 1 : 0; u <= std::min(x + 1, width - 1); ++u)
        if (traced_ids[v * width + u] != traced_ids[y * width + x]) return false;
    return true;
  }
};

gpu::Frame frame_of(const PackedScene& packed, const View& view, const FrameSettings& settings) {
  gpu::Frame frame{};
  set_camera(view, packed.origin, frame);
  frame.width = frame.film_width = settings.width;
  frame.height = frame.film_height = settings.height;
  frame.seed = settings.seed;
  frame.root = packed.root;
  frame.root_is_top = packed.root_is_top ? 1u : 0u;
  frame.sample_total = 16;
  frame.slot_count = settings.width * settings.height;
  frame.scene_features = static_cast<std::uint32_t>(packed.features);
  return frame;
}

std::vector<Seen> identify(const PackedScene& packed, const std::vector<gpu::Hit>& hits) {
  std::vector<Seen> ids;
  for (const gpu::Hit& hit : hits) {
    if (hit.triangle == gpu::kNone)
      ids.emplace_back();
    else
      ids.push_back({packed.triangles[hit.triangle].id, packed.root_is_top ? packed.instances[hit.instance].id : 0});
  }
  return ids;
}

// All that a frame is made from on the device.
class Camera {
public:
  Camera(Device& device, const PackedScene& packed, const View& view, const FrameSettings& settings)
      : device_(device),
        packed_(packed),
        settings_(settings),
        features_(packed.features | camera_features(frame_of(packed, view, settings))),
        pixels_(settings.width * settings.height),
        scene_(upload_scene(device, packed)),
        frame_(upload(device, std::vector{frame_of(packed, view, settings)})),
        hybrid_(device, sizeof(gpu::HybridFrame)),
        rays_(device, 2 * pixels_ * sizeof(gpu::Ray)),
        hits_(device, pixels_ * sizeof(gpu::Hit)),
        queues_(device, sizeof(gpu::Queues)),
        unused_(device, 0) {
    const ClipPlanes planes = clip_planes(packed, view);
    gpu::HybridFrame hybrid{};
    hybrid.jitter = settings.jitter;
    hybrid.near = planes.near;
    hybrid.far = planes.far;
    hybrid.sample_index = settings.sample_index;
    hybrid_.write(&hybrid, sizeof(hybrid));
    queues_.fill_zero();
  }

  const Buffer& frame() const { return frame_; }
  const Buffer& hybrid() const { return hybrid_; }
  const DeviceScene& scene() const { return scene_; }
  gpu::Feature features() const { return features_; }

  Shot compare(const Visibility& visibility) {
    std::vector<Binding> bindings = path_layout();
    std::vector<Binding> given = scene_.bindings();
    using enum BindingKind;
    given.insert(given.end(), {{gpu::kBindFrame, uniform, &frame_},
                               {gpu::kBindRays, storage, &rays_},
                               {gpu::kBindRayTexels, texels_rgba32f, &rays_},
                               {gpu::kBindHits, storage, &hits_},
                               {gpu::kBindHitTexels, texels_rgba32ui, &hits_},
                               {gpu::kBindQueues, storage, &queues_},
                               {gpu::kBindHybrid, uniform, &hybrid_},
                               {gpu::kBindVisibility, texels_rg32ui, &visibility.ids()}});
    bindings.insert(bindings.end(),
                    {{gpu::kBindHybrid, uniform, nullptr}, {gpu::kBindVisibility, texels_rg32ui, nullptr}});
    for (Binding& binding : bindings) {
      const auto found = std::ranges::find(given, binding.slot, &Binding::slot);
      binding.buffer = found == given.end() ? &unused_ : found->buffer;
    }
    const BindingSet set(device_, bindings, sizeof(gpu::Wave));
    Shot shot;
    shot.width = settings_.width;
    shot.height = settings_.height;
    shot.rasterized = run(set, wavepath_visibility_probe_spv);
    shot.traced = run(set, wavepath_extend_spv);
    shot.raster_ids = identify(packed_, shot.rasterized);
    shot.traced_ids = identify(packed_, shot.traced);
    return shot;
  }

private:
  std::vector<gpu::Hit> run(const BindingSet& set, std::span<const std::uint32_t> spirv) {
    std::array<std::uint32_t, gpu::kSpecCount> constants{};
    constants[gpu::kSpecFeatures] = static_cast<std::uint32_t>(features_);
    constants[gpu::kSpecLobes] = static_cast<std::uint32_t>(features_ >> 32);
    constants[gpu::kSpecStackSize] = packed_.stack_size + 2;
    constants[gpu::kSpecWalk] = device_.info().type == "cpu" ? gpu::kWalkInStep : gpu::kWalkByLane;
    const Kernel kernel(device_, "probe", spirv, set, constants);
    const gpu::Wave wave{0, pixels_, settings_.sample_index, 1, 0, 0};
    Commands commands(device_);
    commands.bind(set);
    commands.dispatch(kernel, (pixels_ + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize, &wave);
    commands.submit_and_wait();
    const std::vector<gpu::Hit> by_slot = download<gpu::Hit>(hits_, pixels_);
    std::vector<gpu::Hit> by_row(pixels_);
    for (std::uint32_t slot = 0; slot < pixels_; ++slot) {
      const glm::uvec2 pixel = gpu::pixel_in_tile_order(slot, settings_.width, settings_.height);
      by_row[pixel.y * settings_.width + pixel.x] = by_slot[slot];
    }
    return by_row;
  }

  Device& device_;
  const PackedScene& packed_;
  FrameSettings settings_;
  gpu::Feature features_;
  std::uint32_t pixels_;
  DeviceScene scene_;
  Buffer frame_, hybrid_, rays_, hits_, queues_, unused_;
};

// By rasterization, or else by the traced twin of it.
Shot shoot(Device& device, const PackedScene& packed, const View& view, const FrameSettings& settings,
           bool rasterize = true) {
  Camera camera(device, packed, view, settings);
  Visibility visibility(device, packed, camera.scene(), camera.frame(), camera.hybrid(), camera.features(),
                        settings.width, settings.height, rasterize);
  Workspace workspace(device, packed, 1024, kTraversalCompute);
  WaveQueue queue(workspace);
  visibility.render(queue, camera_of(packed, view), [](Commands&) {}, {view.shift, view.clip});
  queue.drain();
  return camera.compare(visibility);
}

struct Agreement {
  std::uint32_t interior = 0, edges = 0, different = 0; // pixels; `different`: of `edges`
  std::uint32_t seen = 0;                               // where anything is
};

// Pixels without an edge must agree to the bit, weights included.
Agreement agreement(const PackedScene& packed, const Shot& shot) {
  Agreement result;
  std::uint32_t wrong = 0;
  for (std::uint32_t y = 0; y < shot.height; ++y)
    for (std::uint32_t x = 0; x < shot.width; ++x) {
      const std::size_t i = y * shot.width + x;
      const gpu::Hit &raster = shot.rasterized[i], &traced = shot.traced[i];
      const bool same = shot.raster_ids[i] == shot.traced_ids[i];
      result.seen += traced.triangle != gpu::kNone;
      if (!shot.is_interior(x, y)) {
        ++result.edges;
        result.different += !same;
      } else {
        ++result.interior;
        if (!same && ++wrong < 5)
          ADD_FAILURE() << "pixel " << x << "," << y << " shows triangle " << shot.raster_ids[i].triangle << " of "
                        << shot.raster_ids[i].instance << ", a ray meets " << shot.traced_ids[i].triangle << " of "
                        << shot.traced_ids[i].instance;
      }
      if (raster.triangle == traced.triangle && (raster.b1 != traced.b1 || raster.b2 != traced.b2) && ++wrong < 5)
        ADD_FAILURE() << "weights at " << x << "," << y << ": " << raster.b1 << " " << raster.b2 << ", traced "
                      << traced.b1 << " " << traced.b2;
    }
  EXPECT_EQ(wrong, 0u) << "of " << shot.width * shot.height << " pixels, " << packed.triangles.size() << " triangles";
  return result;
}

// Rasterizers round corners to a grid of 1/256 pixel (Vulkan asks for 1/16 at least), so that an edge changes sides
// with one in 256 of the pixels that it crosses; few pixels of these scenes are crossed by more than two.
constexpr double kLargestFraction = 0.01;

void expect_agreement(const PackedScene& packed, const Shot& shot, double largest_fraction = kLargestFraction) {
  const Agreement found = agreement(packed, shot);
  EXPECT_GT(found.seen, 0u);
  EXPECT_LE(found.different, std::ceil(largest_fraction * found.edges)) << "of " << found.edges << " pixels with edges";
}

View look(const glm::dvec3& eye, const glm::dvec3& target, double yfov_degrees, const FrameSettings& settings) {
  ViewRequest request;
  request.eye = eye;
  request.look_at = target;
  request.yfov = glm::radians(yfov_degrees);
  return resolve_view(Scene{}, request, settings.width, settings.height);
}

// Two triangles, counter-clockwise seen from where `u` x `v` points.
std::vector<glm::vec3> rectangle(glm::vec3 corner, glm::vec3 u, glm::vec3 v) {
  return {corner, corner + u, corner + u + v, corner, corner + u + v, corner + v};
}

Scene scene_of(const std::vector<std::vector<glm::vec3>>& meshes) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  for (const std::vector<glm::vec3>& mesh : meshes) add_instance(scene, add_mesh(scene, mesh));
  return scene;
}

class VisibilityBuffer : public VulkanTest {
protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (IsSkipped() || HasFatalFailure()) return;
    if (!device().rasterizes()) GTEST_SKIP() << "a queue that cannot rasterize";
  }

  void check_file(const std::filesystem::path& path, const FrameSettings& settings = {},
                  const ViewRequest& request = {}, bvh::Quality quality = bvh::Quality::fast) {
    SCOPED_TRACE(path.filename().string());
    Scene scene = load_gltf(path);
    const View view = resolve_view(scene, request, settings.width, settings.height);
    const PackedScene packed = pack(scene, {.quality = quality, .eye = view.position});
    expect_agreement(packed, shoot(device(), packed, view, settings));
  }
};

TEST_F(VisibilityBuffer, GeneratedScenes) {
  for (const char* name : {"cornell_box.gltf", "showcase.glb", "furnace_metal.gltf", "analytic/alpha_blend.gltf",
                           "analytic/alpha_mask_cut.gltf"})
    check_file(kSource / "scenes" / name);
}

TEST_F(VisibilityBuffer, RealScenes) {
  if (!std::filesystem::exists(kShared)) GTEST_SKIP() << "no shared/scenes beside the repository";
  ViewRequest sponza;
  sponza.eye = {4, 1.8, 0.2};
  sponza.look_at = {-10, 2.2, -0.3};
  sponza.yfov = glm::radians(65.0);
  check_file(kShared / "Sponza/Sponza.gltf", {}, sponza);
  check_file(kShared / "Sponza/Sponza.gltf", {.sample_index = 4}, sponza, bvh::Quality::best); // holds copies
  for (const char* name :
       {"AlphaBlendModeTest/glTF-Binary/AlphaBlendModeTest.glb", "NegativeScaleTest/glTF-Binary/NegativeScaleTest.glb",
        "SimpleInstancing/glTF-Binary/SimpleInstancing.glb", "TwoSidedPlane/glTF/TwoSidedPlane.gltf",
        "Cameras/glTF/Cameras.gltf", "DamagedHelmet/glTF-Binary/DamagedHelmet.glb"})
    check_file(kShared / name);
  ViewRequest orthographic;
  orthographic.camera = "1";
  check_file(kShared / "Cameras/glTF/Cameras.gltf", {}, orthographic);
}

TEST_F(VisibilityBuffer, AnyPositionInThePixelAndAnySize) {
  for (const FrameSettings& settings :
       {FrameSettings{1, 1, {0, 0}}, FrameSettings{37, 23, {-1.4f, 1.3f}}, FrameSettings{1, 64, {0.49f, -0.49f}},
        FrameSettings{127, 3, {-0.5f, 0.5f}}, FrameSettings{65, 65, {0, 0}}})
    check_file(kSource / "scenes/cornell_box.gltf", settings);
}

// Frustums that are off the axis, or cut by planes across the scene, of either projection. Depth 1 is in the middle of
// what is seen.
struct CutOrShifted {
  const char* name;
  glm::dvec2 shift{0.0};
  std::optional<Intrinsics> intrinsics{};
  Clip clip{};
  bool flat = false;
};
constexpr Clip kSlab{0.6, 1.1};
const CutOrShifted kCutAndShifted[] = {{.name = "shift", .shift = {0.3, -0.4}},
                                       {.name = "nearly out of the picture", .shift = {-0.45, 0.4}},
                                       {.name = "intrinsics", .intrinsics = Intrinsics{140.0, 110.0, 30.0, 70.0}},
                                       {.name = "near", .clip = {.near = 1.0}},
                                       {.name = "far", .clip = {.far = 1.0}},
                                       {.name = "slab", .clip = kSlab},
                                       {.name = "shifted slab", .shift = {0.2, 0.1}, .clip = kSlab},
                                       {.name = "orthographic slab", .clip = kSlab, .flat = true},
                                       {.name = "orthographic near", .clip = {.near = 1.0}, .flat = true}};

TEST_F(VisibilityBuffer, ShiftedAndClippedCameras) {
  const std::pair<const char*, double> scenes[] = {
      {"cornell_box.gltf", 1.1}, {"showcase.glb", 7.6}, {"analytic/alpha_blend.gltf", 1.5}};
  for (const auto& [name, depth] : scenes) {
    for (const CutOrShifted& camera : kCutAndShifted) {
      SCOPED_TRACE(camera.name);
      ViewRequest request{.intrinsics = camera.intrinsics,
                          .clip = Clip{depth * camera.clip.near, depth * camera.clip.far}};
      if (camera.shift != glm::dvec2(0.0)) request.shift = camera.shift;
      if (camera.flat) request.projection = Projection::orthographic;
      check_file(kSource / "scenes" / name, {}, request);
    }
  }
}

// What a plane cuts away is not there: a wall between eye and object, or an object behind the far plane.
TEST_F(VisibilityBuffer, ClipPlanesUncoverWhatIsBehind) {
  Scene scene =
      scene_of({rectangle({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}), rectangle({-5, -5, -2}, {10, 0, 0}, {0, 10, 0})});
  const FrameSettings settings{32, 24};
  for (const bool flat : {false, true}) {
    const auto wall_of = [&](const Clip& clip) {
      ViewRequest request{.eye = glm::dvec3(0.1, 0.2, 3.0), .look_at = glm::dvec3(0.1, 0.2, 0.0), .clip = clip};
      if (flat) request.projection = Projection::orthographic, request.ymag = 1.0;
      const View view = resolve_view(scene, request, settings.width, settings.height);
      const PackedScene packed = pack(scene, {.eye = view.position});
      const Shot shot = shoot(device(), packed, view, settings);
      expect_agreement(packed, shot);
      const std::uint32_t triangle = shot.raster_ids[12 * 32 + 16].triangle;
      return triangle == gpu::kNone ? -1 : static_cast<int>(triangle / 2);
    };
    EXPECT_EQ(wall_of({.near = 2.999}), 0);
    EXPECT_EQ(wall_of({.near = 3.001}), 1);
    EXPECT_EQ(wall_of({.near = 3.001, .far = 5.001}), 1);
    EXPECT_EQ(wall_of({.near = 2.999, .far = 3.001}), 0);
  }
}

TEST_F(VisibilityBuffer, NothingToSee) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  const PackedScene packed = pack(scene);
  EXPECT_TRUE(packed.draws.empty());
  const FrameSettings settings{9, 5};
  const Shot shot = shoot(device(), packed, look({0, 0, 1}, {0, 0, 0}, 45, settings), settings);
  EXPECT_EQ(shot.raster_ids, std::vector<Seen>(45));
}

// A tenth of a millimetre from a wall of ten metres, with a second one as close behind it. The diagonal of the wall is
// known to 2^-24 of its length, which is half a pixel here.
TEST_F(VisibilityBuffer, NearPlane) {
  Scene scene =
      scene_of({rectangle({-5, -5, 0}, {10, 0, 0}, {0, 10, 0}), rectangle({-5, -5, -1e-4f}, {10, 0, 0}, {0, 10, 0})});
  const FrameSettings settings{64, 48};
  for (const glm::dvec3 target : {glm::dvec3(0, 0, 0), glm::dvec3(3e-4, 1e-4, 0), glm::dvec3(1, 0.01, 0)}) {
    const glm::dvec3 eye(0, 0, 1e-4);
    const PackedScene packed = pack(scene, {.eye = eye});
    const Shot shot = shoot(device(), packed, look(eye, target, 60, settings), settings);
    expect_agreement(packed, shot, 0.5);
    for (std::size_t i = 0; i < shot.raster_ids.size(); ++i) // the front wall, wherever a ray meets it
      EXPECT_EQ(shot.raster_ids[i].triangle / 2, shot.traced_ids[i].triangle / 2);
  }
}

// Two micrometres of a floor of two kilometres: where its edges lie is beyond what clipping can tell.
TEST_F(VisibilityBuffer, WindowBelowThePrecisionOfEdges) {
  Scene scene = load_gltf(kSource / "scenes/analytic/occlusion_in_corner.gltf");
  const FrameSettings settings{40, 30};
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  const PackedScene packed = pack(scene, {.eye = view.position});
  EXPECT_FALSE(edges_hold(packed, view, settings.width, settings.height));
  const Shot shot = shoot(device(), packed, view, settings, false);
  EXPECT_EQ(shot.raster_ids, shot.traced_ids);
  for (const Seen& seen : shot.raster_ids) EXPECT_NE(seen.triangle, gpu::kNone);
}

TEST_F(VisibilityBuffer, TracedTwinEqualsThePathTracer) {
  const FrameSettings settings{83, 61};
  for (const char* name : {"showcase.glb", "analytic/alpha_blend.gltf"}) {
    Scene scene = load_gltf(kSource / "scenes" / name);
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    const PackedScene packed = pack(scene);
    EXPECT_TRUE(edges_hold(packed, view, settings.width, settings.height));
    const Shot shot = shoot(device(), packed, view, settings, false);
    EXPECT_EQ(shot.raster_ids, shot.traced_ids);
  }
}

// Walls all around, whose triangles reach far behind the eye, at a wide angle.
TEST_F(VisibilityBuffer, InsideABox) {
  std::vector<glm::vec3> walls;
  for (int axis = 0; axis < 3; ++axis)
    for (const float side : {-1.0f, 1.0f}) {
      glm::vec3 corner(-1.0f), u(0.0f), v(0.0f);
      corner[axis] = side;
      u[(axis + 1) % 3] = v[(axis + 2) % 3] = 2.0f;
      const std::vector<glm::vec3> wall = rectangle(corner, u, v);
      walls.insert(walls.end(), wall.begin(), wall.end());
    }
  Scene scene = scene_of({walls});
  const FrameSettings settings{101, 77};
  for (const glm::dvec3 eye :
       {glm::dvec3(0.1, 0.2, -0.3), glm::dvec3(0.9999, -0.9999, 0.9999), glm::dvec3(0, -0.99999, 0)}) {
    const PackedScene packed = pack(scene, {.eye = eye});
    const Shot shot = shoot(device(), packed, look(eye, {-0.3, 0.4, 0.1}, 120, settings), settings);
    expect_agreement(packed, shot);
    for (const Seen& seen : shot.raster_ids) EXPECT_NE(seen.triangle, gpu::kNone);
  }
}

// Long triangles through the plane of the camera, at every angle, in a cloud around the eye; more than one slice holds.
TEST_F(VisibilityBuffer, TrianglesAcrossTheCameraPlane) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  for (const int count : {3, 200, 70000}) {
    std::vector<glm::vec3> corners;
    for (int i = 0; i < count; ++i) {
      const glm::vec3 centre = glm::vec3(unit(random), unit(random), unit(random)) * 10.0f;
      const float size = count > 1000 ? 0.3f : 8.0f;
      for (int k = 0; k < 3; ++k)
        corners.push_back(centre + size * glm::vec3(unit(random), unit(random), unit(random)));
    }
    Scene scene = scene_of({corners});
    const FrameSettings settings{96, 64};
    const PackedScene packed = pack(scene, {.eye = glm::dvec3(0.0)});
    expect_agreement(packed, shoot(device(), packed, look({0, 0, 0}, {0.2, 0.1, -1}, 90, settings), settings));
  }
}

// A millimetre before the lens and a thousand kilometres away in one picture, and far away two walls of which one
// stands a hundred thousandth of the distance behind the other.
TEST_F(VisibilityBuffer, ExtremeDepths) {
  Scene scene = scene_of({rectangle({-1e-4f, -1e-4f, -1e-3f}, {2e-4f, 0, 0}, {0, 2e-4f, 0}),
                          rectangle({-3e5f, -3e5f, -1e6f}, {4e5f, 0, 0}, {0, 6e5f, 0}),
                          rectangle({-3e5f, -3e5f, -1.00001e6f}, {6e5f, 0, 0}, {0, 6e5f, 0}),
                          rectangle({-0.5f, -1, -1.00001f}, {1, 0, 0}, {0, 0.8f, 0}),
                          rectangle({-0.5f, -1, -1}, {0.5f, 0, 0}, {0, 0.8f, 0})});
  const FrameSettings settings{128, 96};
  const PackedScene packed = pack(scene, {.eye = glm::dvec3(0.0)});
  const Shot shot = shoot(device(), packed, look({0, 0, 0}, {0, 0, -1}, 50, settings), settings);
  expect_agreement(packed, shot);
  std::vector<std::uint32_t> pixels(5);
  for (const Seen& seen : shot.raster_ids)
    if (seen.triangle != gpu::kNone) ++pixels[seen.triangle / 2];
  for (const std::uint32_t count : pixels) EXPECT_GT(count, 100u);
}

// The hash decides for every triangle, instance and sample as it does for a traced ray.
TEST_F(VisibilityBuffer, StochasticAlpha) {
  Scene scene = scene_of({});
  scene.materials[0].alpha_mode = AlphaMode::blend;
  scene.materials[0].base_color.a = 0.4f;
  const std::uint32_t mesh = add_mesh(scene, rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  for (int i = 0; i < 4; ++i) add_instance(scene, mesh, glm::translate(glm::dmat4(1.0), glm::dvec3(0.1 * i, 0, -i)));
  const PackedScene packed = pack(scene);
  EXPECT_TRUE(packed.root_is_top);
  std::vector<Shot> shots;
  for (const std::uint32_t sample : {0u, 1u, 6u}) {
    const FrameSettings settings{.width = 64, .height = 64, .sample_index = sample};
    shots.push_back(shoot(device(), packed, look({0, 0, 3}, {0, 0, 0}, 30, settings), settings));
    std::uint32_t different = 0;
    for (std::size_t i = 0; i < shots.back().traced_ids.size(); ++i)
      different += shots.back().traced_ids[i] != shots.back().raster_ids[i];
    EXPECT_LE(different, 4u); // on the diagonals
  }
  EXPECT_NE(shots[0].raster_ids, shots[1].raster_ids);
}

TEST_F(VisibilityBuffer, SingleSided) {
  Scene scene = scene_of({});
  scene.materials[0].double_sided = false;
  scene.materials.push_back(plain_material());
  const std::uint32_t front = add_mesh(scene, rectangle({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}));
  add_instance(scene, front);
  add_instance(scene, front, glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 1)), glm::dvec3(-1, 1, 1)));
  add_instance(scene, front,
               glm::rotate(glm::translate(glm::dmat4(1.0), glm::dvec3(0, 0, 2)), 3.1, glm::dvec3(0, 1, 0)));
  const PackedScene packed = pack(scene);
  const FrameSettings settings{64, 64};
  for (const double z : {6.0, -4.0}) {
    const Shot shot = shoot(device(), packed, look({0.3, 0.2, z}, {0, 0, 1}, 40, settings), settings);
    expect_agreement(packed, shot);
    EXPECT_EQ(shot.raster_ids[32 * 64 + 30].instance, z > 0 ? 1u : 2u);
  }
}

TEST_F(VisibilityBuffer, SameBitsEveryTime) {
  Scene scene = load_gltf(kSource / "scenes/showcase.glb");
  const FrameSettings settings{80, 60};
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  const PackedScene packed = pack(scene);
  Camera camera(device(), packed, view, settings);
  Visibility visibility(device(), packed, camera.scene(), camera.frame(), camera.hybrid(), camera.features(),
                        settings.width, settings.height, true);
  Workspace workspace(device(), packed, 1024, kTraversalCompute);
  WaveQueue queue(workspace);
  const auto words = [&] {
    visibility.render(queue, camera_of(packed, view), [](Commands&) {});
    queue.drain();
    return download<std::uint32_t>(visibility.ids(), std::size_t{2} * settings.width * settings.height);
  };
  const std::vector<std::uint32_t> first = words();
  EXPECT_EQ(words(), first);
  ASSERT_EQ(queue.totals.stages.size(), 1u);
  EXPECT_EQ(queue.totals.stages.front().name, "raster");
  EXPECT_GT(queue.totals.stages.front().seconds, 0.0);
  EXPECT_GE(visibility.bytes(), std::uint64_t{20} * settings.width * settings.height); // 8 twice, and 4 of depth
}

TEST_F(VisibilityBuffer, TooLargeASizeIsRefusedInWords) {
  try {
    const AttachmentInfo words{.name = "visibility", .format = ImageFormat::rg32ui};
    const RasterTarget target(device(), 1u << 20, 4, {&words, 1});
    FAIL() << "no device draws a million pixels wide";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("use a smaller --size or --integrator path"), std::string::npos)
        << error.what();
  }
}

// Every triangle that a traced ray finds is among those drawn, and a view of a part of the scene draws a part of it.
TEST_F(VisibilityBuffer, DrawsWhatIsSeenAndLeavesOutTheRest) {
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.0f, 1.0f);
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  std::vector<glm::vec3> soup;
  for (int t = 0; t < 20000; ++t) {
    const glm::vec3 at(20.0f * unit(random), 20.0f * unit(random), 20.0f * unit(random));
    for (int corner = 0; corner < 3; ++corner)
      soup.push_back(at + 0.2f * glm::vec3(unit(random), unit(random), unit(random)));
  }
  const std::uint32_t mesh = add_mesh(scene, soup), small = add_mesh(scene, kUnitTriangle);
  add_instance(scene, mesh);
  for (int i = 0; i < 50; ++i)
    add_instance(scene, small,
                 glm::translate(glm::dmat4(1.0), glm::dvec3(unit(random), unit(random), unit(random)) * 20.0));
  const PackedScene packed = pack(scene);
  const std::vector<Chunk> chunks = make_chunks(packed);
  for (int i = 0; i < 6; ++i) {
    View view = resolve_view(scene,
                             {.eye = glm::dvec3(unit(random), unit(random), unit(random)) * 15.0,
                              .look_at = glm::dvec3(unit(random)) * 10.0},
                             160, 90);
    view.orthographic = i % 2 == 1;
    if (view.orthographic)
      view.right *= 8.0, view.up *= 8.0;
    else
      view.shift = {0.4 * i, -0.3 * i};
    view.clip = i >= 3 ? Clip{2.0, 12.0} : Clip{};
    const ShownPart part{view.shift, view.clip};
    std::uint64_t drawn = 0, total = 0;
    for (const Draw& draw : packed.draws) total += std::uint64_t{draw.triangle_count} * draw.instance_count;
    for (const Draw& draw : visible_draws(chunks, camera_of(packed, view), 160, 90, part))
      drawn += std::uint64_t{draw.triangle_count} * draw.instance_count;
    EXPECT_LT(drawn, 3 * total / 4);
    EXPECT_GT(drawn, 0u);
    const Shot shot = shoot(device(), packed, view, {});
    std::size_t missing = 0;
    for (std::size_t p = 0; p < shot.raster_ids.size(); ++p)
      missing += shot.raster_ids[p].triangle == gpu::kNone && shot.traced_ids[p].triangle != gpu::kNone;
    EXPECT_LT(missing, shot.raster_ids.size() / 100); // pixels of edges
  }
}

} // namespace
} // namespace wavepath::test
