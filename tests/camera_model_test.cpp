// Cameras beyond a pinhole about the picture's middle: directions pixel by pixel against closed forms, by the device's
// functions and by each integrator; and the same light from both ends of paths.
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <string>

#include "host/base/error.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/picture/files/picture_io.h"
#include "host/render/workspace/workspace.h"
#include "kernels/base/frame_types.h"
#include "tests/bidirectional_scene.h"
#include "tests/probe.h"
#include "tests/probes/camera_probe.spv.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::uint32_t kWidth = 48, kHeight = 32;
constexpr double kNothingSeen = 1e9; // depths from here on

struct Case {
  std::string name;
  ViewRequest request;
};
void PrintTo(const Case& one, std::ostream* out) { *out << one.name; }

ViewRequest seen_from(ViewRequest request) {
  request.eye = glm::dvec3(0.3, 0.5, 2.5), request.look_at = glm::dvec3(-0.2, 0.3, 0.0);
  return request;
}

const std::vector<Case> kCases = {
    {"shift", seen_from({.yfov = 0.9, .shift = glm::dvec2(0.3, -0.2)})},
    {"intrinsics", seen_from({.intrinsics = Intrinsics{40.0, 30.0, 20.0, 18.0}})},
    {"clip", seen_from({.yfov = 0.9, .clip = Clip{1.5, 3.5}})},
    {"stereo", seen_from({.yfov = 0.9, .stereo = 0.3})},
    {"orthographic",
     seen_from(
         {.projection = Projection::orthographic, .ymag = 1.0, .shift = glm::dvec2(0.2, 0.1), .clip = Clip{1.0, 4.0}})},
    {"fisheye", seen_from({.projection = Projection::fisheye, .fov = 3.3})},
    {"fisheye_of_intrinsics",
     seen_from({.projection = Projection::fisheye, .intrinsics = Intrinsics{15.0, 12.0, 26.0, 15.0}})},
    {"fisheye_stereo", seen_from({.projection = Projection::fisheye, .stereo = 0.2})},
    {"sphere", seen_from({.projection = Projection::equirectangular, .clip = Clip{0.2, 30.0}})},
    {"sphere_stereo", seen_from({.projection = Projection::equirectangular, .stereo = 0.2})},
    {"fast", seen_from({.yfov = 0.9, .shift = glm::dvec2(0.1, 0.0), .velocity = {0.2, -0.1, -0.6}})},
    {"fast_fisheye", seen_from({.projection = Projection::fisheye, .fov = 3.3, .velocity = {0.4, 0.3, 0.2}})},
    {"fast_sphere",
     seen_from({.projection = Projection::equirectangular, .clip = Clip{0.2, 30.0}, .velocity = {-0.3, 0.5, -0.1}})},
};

struct Seen {
  glm::vec2 position;
  std::uint32_t eye = 0, sees = 0;
  glm::vec3 origin;
  float length = 0;
  glm::vec3 direction;
  float stretch = 0;
  glm::vec2 again;
  std::uint32_t pixel = 0;
  float weight = 0;
  glm::vec2 u, pad;
};
static_assert(sizeof(Seen) == 80);

struct Ray {
  glm::dvec3 origin, direction;
  bool sees = true;
  double reach = std::numeric_limits<double>::infinity();
};

// The closed form, by nothing but what the flags say; `position` in pixels of the whole picture.
Ray expected_ray(const ViewRequest& r, glm::dvec2 position, bool right_eye) {
  const glm::dvec3 forward = glm::normalize(*r.look_at - *r.eye),
                   right = glm::normalize(glm::cross(forward, glm::dvec3(0, 1, 0))), up = glm::cross(right, forward);
  glm::dvec2 size(kWidth, kHeight);
  const bool is_sphere = r.projection == Projection::equirectangular;
  if (r.stereo > 0.0) {
    const int axis = is_sphere ? 1 : 0;
    size[axis] /= 2.0;
    if (right_eye) position[axis] -= size[axis];
  }
  const double aside = r.stereo == 0.0 ? 0.0 : (right_eye ? 0.5 : -0.5) * r.stereo;
  Ray ray{*r.eye + aside * right, forward};
  const glm::dvec2 middle = position - 0.5 * size; // rows go down
  double step = 1.0;
  if (is_sphere) {
    const double azimuth = 2.0 * kPi * middle.x / size.x, elevation = -kPi * middle.y / size.y;
    ray.direction =
        std::cos(elevation) * (std::cos(azimuth) * forward + std::sin(azimuth) * right) + std::sin(elevation) * up;
    ray.origin = *r.eye + aside * (std::cos(azimuth) * right - std::sin(azimuth) * forward);
  } else if (r.projection == Projection::fisheye) {
    glm::dvec2 angles = r.fov.value_or(kPi) / std::min(size.x, size.y) * middle;
    if (const auto& k = r.intrinsics) angles = (position - glm::dvec2(k->cx, k->cy)) / glm::dvec2(k->fx, k->fy);
    const double angle = glm::length(angles);
    ray.sees = angle <= (r.intrinsics ? kPi : 0.5 * r.fov.value_or(kPi));
    const glm::dvec2 along = angle > 0.0 ? angles / angle : angles;
    ray.direction = std::cos(angle) * forward + std::sin(angle) * (along.x * right - along.y * up);
  } else {
    const glm::dvec2 shift = r.shift.value_or(glm::dvec2(0.0)) * size;
    const bool flat = r.projection == Projection::orthographic;
    const double scale = flat ? 2.0 * *r.ymag / size.y : 2.0 * std::tan(0.5 * r.yfov.value_or(1.0)) / size.y;
    glm::dvec2 across = scale * (middle + glm::dvec2(shift.x, -shift.y));
    if (const auto& k = r.intrinsics) across = (position - glm::dvec2(k->cx, k->cy)) / glm::dvec2(k->fx, k->fy);
    const glm::dvec3 offset = across.x * right - across.y * up;
    if (flat) ray.origin += offset;
    if (!flat) ray.direction = glm::normalize(forward + offset);
    step = 1.0 / glm::dot(ray.direction, forward);
  }
  if (const double speed = glm::length(r.velocity); speed > 0.0) {
    const glm::dvec3 axis = r.velocity / speed;
    const double seen = glm::dot(ray.direction, axis), cosine = (seen - speed) / (1.0 - speed * seen);
    ray.direction = cosine * axis + std::sqrt(1.0 - cosine * cosine) * glm::normalize(ray.direction - seen * axis);
    step = 1.0;
  }
  if (!r.clip) return ray;
  ray.origin += r.clip->near * step * ray.direction;
  ray.reach = (r.clip->far - r.clip->near) * step;
  return ray;
}

bool is_right_eye(const ViewRequest& request, glm::uvec2 pixel) {
  if (request.stereo == 0.0) return false;
  return request.projection == Projection::equirectangular ? pixel.y >= kHeight / 2 : pixel.x >= kWidth / 2;
}

class CameraModel : public BidirectionalTest, public testing::WithParamInterface<Case> {
protected:
  static View view_of(const ViewRequest& request) { return resolve_view(Scene{}, request, kWidth, kHeight); }
};
INSTANTIATE_TEST_SUITE_P(Cameras, CameraModel, testing::ValuesIn(kCases), [](const auto& of) { return of.param.name; });

// What the device makes of `side`^2 positions in every pixel.
std::vector<Seen> ask_device(Device& device, const ViewRequest& request, const View& view, std::uint32_t filter,
                             std::uint32_t side) {
  gpu::Frame frame{};
  frame.width = frame.film_width = kWidth, frame.height = frame.film_height = kHeight;
  set_camera(view, glm::dvec3(0.0), frame);
  std::mt19937 random(1);
  std::uniform_real_distribution<float> unit(0.0f, 1.0f);
  std::vector<Seen> all;
  const std::uint32_t in_pixel = side * side;
  for (std::uint32_t i = 0; i < in_pixel * kWidth * kHeight; ++i) {
    const glm::uvec2 pixel(i / in_pixel % kWidth, i / in_pixel / kWidth);
    Seen& seen = all.emplace_back();
    const glm::vec2 cell(i % side, i % in_pixel / side);
    seen.position = glm::vec2(pixel) + (cell + glm::vec2(0.4f, 0.3f)) / static_cast<float>(side);
    seen.u = {unit(random), unit(random)};
    seen.eye = is_right_eye(request, pixel) ? 1 : 0;
  }
  std::vector<ProbeBuffer> buffers = {to_probe(std::vector<gpu::Frame>{frame}), to_probe(all)};
  std::vector<std::uint32_t> constants(gpu::kSpecCount);
  constants[gpu::kSpecFeatures] = static_cast<std::uint32_t>(gpu::kFeatureOrthographic);
  constants[gpu::kSpecLobes] = static_cast<std::uint32_t>(camera_features(frame) >> 32);
  constants[gpu::kSpecFilter] = filter;
  run_probe(device, wavepath_camera_probe_spv, static_cast<std::uint32_t>(all.size()), buffers, constants);
  return from_probe<Seen>(buffers[1]);
}

TEST_P(CameraModel, RaysAreThoseOfTheClosedForm) {
  const ViewRequest& request = GetParam().request;
  const View view = view_of(request);
  const std::vector<Seen> all = ask_device(device(), request, view, gpu::kFilterBox, 2);
  double area = 0.0; // of all directions that a panorama shows
  for (const Seen& seen : all) {
    SCOPED_TRACE(testing::Message() << seen.position.x << ", " << seen.position.y);
    const Ray ray = expected_ray(request, glm::dvec2(seen.position), seen.eye != 0);
    ASSERT_EQ(seen.sees != 0, ray.sees);
    if (!ray.sees) continue;
    ASSERT_LT(glm::length(glm::dvec3(seen.origin) - ray.origin), 2e-6);
    ASSERT_LT(glm::length(glm::dvec3(seen.direction) - ray.direction), 1e-6);
    ASSERT_EQ(std::isinf(ray.reach), seen.length == gpu::kFar);
    if (!std::isinf(ray.reach)) {
      ASSERT_NEAR(seen.length, ray.reach, 1e-5 * ray.reach);
    }
    area += seen.stretch;
    // The way back, to the pixel that it was; less exact where a panorama stretches.
    if (view.panorama != Panorama::none && std::abs(seen.stretch) < 0.02f) continue;
    const float exact = view.panorama == Panorama::none ? 2e-4f : 3e-4f / std::min(1.0f, seen.stretch);
    ASSERT_LT(glm::length(seen.again - seen.position), exact) << seen.again.x << ", " << seen.again.y;
    ASSERT_EQ(glm::uvec2(seen.pixel % kWidth, seen.pixel / kWidth), glm::uvec2(seen.position));
    ASSERT_EQ(seen.weight, 1.0f);
  }
  // A sphere's directions fill 4 pi, a fisheye's the cap up to its rim.
  if (view.panorama == Panorama::none || request.intrinsics) return;
  const double pixel = 4.0 * glm::length(view.right) * glm::length(view.up) / (kWidth * kHeight);
  const double whole = view.panorama == Panorama::sphere ? 4.0 * kPi : 2.0 * kPi * (1.0 - std::cos(view.angle_limit));
  EXPECT_NEAR(0.25 * pixel * area, whole, 0.02 * whole);
}

// Of light that is even over the picture, borders get less, as no pixel beyond them looks at it; a sphere has none.
// None gets into the other eye's picture.
TEST_P(CameraModel, PixelFiltersEndWhereThePictureDoes) {
  const ViewRequest& request = GetParam().request;
  const View view = view_of(request);
  const std::vector<Seen> all = ask_device(device(), request, view, gpu::kFilterBlackmanHarris, 6);
  std::vector<double> rows(kHeight), columns(kWidth);
  for (const Seen& seen : all) {
    const glm::uvec2 pixel(seen.pixel % kWidth, seen.pixel / kWidth);
    if (!(seen.weight > 0.0f)) continue;
    ASSERT_EQ(is_right_eye(request, pixel), seen.eye != 0);
    rows[pixel.y] += seen.weight / (36.0 * kWidth), columns[pixel.x] += seen.weight / (36.0 * kHeight);
  }
  if (view.panorama == Panorama::fisheye) return; // its rim is round
  const bool endless = view.panorama == Panorama::sphere;
  for (std::uint32_t i = 0; i < kHeight; ++i) {
    const bool border = i == 0 || i + 1 == kHeight;
    if (endless) {
      EXPECT_NEAR(rows[i], 1.0, 0.05) << "row " << i;
    } else if (border) {
      EXPECT_LT(rows[i], 0.95 * rows[kHeight / 4]);
    }
  }
  for (std::uint32_t i = 0; i < kWidth; ++i) {
    const bool border = i == 0 || i + 1 == kWidth;
    if (endless) {
      EXPECT_NEAR(columns[i], 1.0, 0.06) << "column " << i;
    } else if (border) {
      EXPECT_LT(columns[i], 0.95 * columns[kWidth / 4]);
    }
  }
}

// The host's own, for what is picked in a window.
TEST_P(CameraModel, PicksAlongTheSameRays) {
  const ViewRequest& request = GetParam().request;
  if (request.stereo > 0.0) return; // picks from between the eyes
  const View view = view_of(request);
  for (const glm::dvec2 at : {glm::dvec2(-0.4, 0.3), glm::dvec2(0.1, 0.2), glm::dvec2(0.6, -0.7)}) {
    const glm::dvec2 position = glm::dvec2(kWidth, kHeight) * 0.5 * glm::dvec2(1.0 + at.x, 1.0 - at.y);
    ViewRequest unclipped = request;
    unclipped.clip.reset();
    const Ray expected = expected_ray(unclipped, position, false);
    Ray ray;
    ASSERT_EQ(ray_through(view, at, ray.origin, ray.direction), expected.sees);
    if (!expected.sees) continue;
    EXPECT_LT(glm::length(ray.origin - expected.origin), 1e-12);
    EXPECT_LT(glm::length(glm::normalize(ray.direction) - expected.direction), 1e-12);
    glm::dvec2 again;
    ASSERT_TRUE(project(view, glm::dvec4(ray.origin + 3.0 * glm::normalize(ray.direction), 1.0), 0, again));
    EXPECT_LT(glm::length(again - at), 1e-9) << "back to the picture";
  }
}

// In a box around everything, with a clip that cuts nothing of it, positions and depths of first hits are on the rays
// through the pixels.
TEST_P(CameraModel, EachIntegratorSeesAlongItsRays) {
  ViewRequest request = GetParam().request;
  if (request.clip) request.clip = Clip{0.1, 50.0};
  const glm::dvec3 forward = glm::normalize(*request.look_at - *request.eye);
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  add_box(scene, glm::vec3(-9.0f), glm::vec3(9.0f), 0);
  RenderPlan asked = settings(1, 1);
  asked.width = kWidth, asked.height = kHeight;
  asked.filter = gpu::kFilterBox;
  asked.aovs = {"position", "depth"};
  Subject subject(scene, asked);
  subject.view = view_of(request);
  const bool stacked = request.projection == Projection::equirectangular, pair = request.stereo > 0.0;
  const double width = std::max(glm::length(subject.view.right) * (pair && !stacked ? 4.0 : 2.0) / kWidth,
                                glm::length(subject.view.up) * (pair && stacked ? 4.0 : 2.0) / kHeight); // of a pixel
  const double speed = glm::length(request.velocity);
  const double widest = width * std::sqrt((1.0 + speed) / (1.0 - speed)); // straight ahead
  for (const IntegratorKind* kind : {&kPath, &kWhitted, &kBidirectional, &kHybrid, &kAo}) {
    SCOPED_TRACE(kind->name);
    if (speed > 0.0 && (kind == &kHybrid || kind == &kAo)) continue;
    asked.integrator = kind;
    const Picture picture = render(subject, asked).picture;
    for (std::uint32_t i = 0; i < kWidth * kHeight; ++i) {
      const glm::uvec2 pixel(i % kWidth, i / kWidth);
      SCOPED_TRACE(testing::Message() << pixel.x << ", " << pixel.y);
      const Ray ray = expected_ray(request, glm::dvec2(pixel) + 0.5, is_right_eye(request, pixel));
      const glm::dvec3 point(find_channel(picture, "P.X")->values[i], find_channel(picture, "P.Y")->values[i],
                             find_channel(picture, "P.Z")->values[i]);
      const double depth = find_channel(picture, "Z")->values[i];
      const bool sees = depth < kNothingSeen;
      if (!ray.sees) { // but for pixels on the rim
        if (sees && speed == 0.0) {
          ASSERT_LT(glm::dot(glm::normalize(point - *request.eye), forward),
                    std::cos(subject.view.angle_limit - 1.5 * width));
        }
        continue;
      }
      if (!sees && speed > 0.0) continue;
      if (!sees) {
        ASSERT_GT(std::acos(glm::dot(ray.direction, forward)), subject.view.angle_limit - 1.5 * width);
        continue;
      }
      const glm::dvec3 offset = point - ray.origin, aside = offset - glm::dot(offset, ray.direction) * ray.direction;
      const double spread = request.projection == Projection::orthographic ? 1.0 : glm::length(offset);
      ASSERT_LT(glm::length(aside), 0.75 * widest * spread + 1e-3);
      const double near = request.clip ? request.clip->near : 0.0;
      const bool from_eye = subject.view.panorama != Panorama::none || speed > 0.0;
      const double expected = from_eye ? glm::length(offset) + near : glm::dot(point - *request.eye, forward);
      ASSERT_NEAR(depth, expected, (pair && stacked ? 1e-3 : 1e-4) * depth); // whose eyes move within a pixel
    }
  }
}

// What lies before the near plane and behind the far one is not there for camera rays: the sky shows through.
TEST_F(BidirectionalTest, ClipPlanesCut) {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  scene.environment.radiance = glm::vec3(1.0f);
  for (const float z : {1.0f, 0.0f, -1.0f})
    add_instance(scene, add_mesh(scene, quad({-9, -9, z}, {9, -9, z}, {9, 9, z}, {-9, 9, z})));
  RenderPlan asked = settings(1, 1);
  asked.aovs = {"depth"};
  for (const Projection projection : {Projection::perspective, Projection::orthographic, Projection::fisheye})
    for (const IntegratorKind* kind : {&kPath, &kWhitted, &kBidirectional, &kHybrid})
      for (const auto& [clip, expected] : {std::pair{Clip{0.0, 5.0}, 2.0},
                                           {Clip{2.5, 5.0}, 3.0},
                                           {Clip{3.5, 9.0}, 4.0},
                                           {Clip{2.1, 2.9}, 0.0},
                                           {Clip{4.1, INFINITY}, 0.0}}) {
        SCOPED_TRACE(testing::Message() << static_cast<int>(projection) << " " << kind->name << " " << clip.near);
        asked.integrator = kind;
        Subject subject(scene, asked);
        ViewRequest request{.eye = glm::dvec3(0, 0, 3), .look_at = glm::dvec3(0.0), .projection = projection};
        if (projection == Projection::fisheye) request.fov = 0.1;
        if (projection == Projection::perspective) request.yfov = 0.1;
        if (projection == Projection::orthographic) request.ymag = 0.1;
        request.clip = clip;
        subject.view = resolve_view(scene, request, asked.width, asked.height);
        const float depth =
            find_channel(render(subject, asked).picture, "Z")->values[asked.width * asked.height / 2 + asked.width / 2];
        if (expected == 0.0) {
          EXPECT_GE(depth, kNothingSeen);
        } else {
          EXPECT_NEAR(depth, expected, 0.01);
        }
      }
}

// A sphere laid out as the environment is shows it as it is.
TEST_F(BidirectionalTest, AnEquirectangularPictureOfTheSkyIsItsMap) {
  Scene scene;
  scene.path = "test";
  add_sky(scene);
  scene.environment.rotation = 0.0;
  RenderPlan asked = settings(16, 1);
  asked.integrator = &kPath;
  asked.width = scene.environment.width, asked.height = scene.environment.height;
  asked.filter = gpu::kFilterBox;
  Subject subject(scene, asked);
  subject.view = resolve_view(
      scene, {.eye = glm::dvec3(0.0), .look_at = glm::dvec3(1.0, 0.0, 0.0), .projection = Projection::equirectangular},
      asked.width, asked.height);
  const Picture picture = render(subject, asked).picture;
  for (std::uint32_t i = 0; i < asked.width * asked.height; ++i) {
    const glm::vec3& texel = scene.environment.map[i];
    ASSERT_NEAR(picture.channels[0].values[i], texel.r, 0.03) << i; // texels are interpolated
    ASSERT_NEAR(picture.channels[1].values[i], texel.g, 1e-4) << i;
    const std::uint32_t row = i / asked.width, column = i % asked.width;
    const bool jumps = row == 2 || row == 3 || column == 0 || column + 1 == asked.width;
    if (!jumps) {
      ASSERT_NEAR(picture.channels[2].values[i], texel.b, 0.05) << i;
    }
  }
}

// Light paths find the pixels that camera paths look from; in a room, so that all directions have light.
TEST_P(CameraModel, LightPathsSeeTheSameLight) {
  Scene scene = corner();
  add_shining_quad(scene, 2.5f);
  add_lamp(scene, LightKind::point);
  add_box(scene, glm::vec3(-3.0f, -1.0f, -2.0f), glm::vec3(3.0f, 3.0f, 4.0f), 0);
  RenderPlan path = path_settings(256, 3);
  const View view = resolve_view(scene, GetParam().request, path.width, path.height);
  const auto average_of = [&](const RenderPlan& asked) {
    Subject subject(scene, asked);
    subject.view = view;
    return average(subject, asked);
  };
  const Average expected = average_of(path);
  for (const std::uint32_t techniques : {gpu::kTechniquesAll, kSplat | kHit}) {
    SCOPED_TRACE(techniques);
    expect_same_mean(average_of(settings(64, 3, techniques)), expected);
  }
  RenderPlan whole = settings(3, 3);
  Subject subject(scene, whole);
  subject.view = view;
  expect_same_film_however_cut(subject, whole, *render(subject, whole).film);
}

// Each technique of frames that goes from points back to pixels is refused by name.
TEST_F(BidirectionalTest, HybridTracesWhatItCannotDraw) {
  Scene scene = corner();
  RenderPlan asked = settings(1, 1);
  asked.integrator = &kHybrid;
  Subject subject(scene, asked);
  subject.view = resolve_view(scene, {.projection = Projection::fisheye}, asked.width, asked.height);
  const std::vector<void (*)(RenderPlan&)> changes = {[](RenderPlan& s) { s.first_hit = kFirstHitRaster; },
                                                      [](RenderPlan& s) { s.shadows = 1; },
                                                      [](RenderPlan& s) { s.occlusion = 1, s.max_depth = 2; },
                                                      [](RenderPlan& s) { s.antialias = 1; },
                                                      [](RenderPlan& s) { s.transparency = 1; },
                                                      [](RenderPlan& s) { s.reflections = 1; },
                                                      [](RenderPlan& s) { s.shading = 1; },
                                                      [](RenderPlan& s) { s.denoise = kDenoiseOn; }};
  for (const auto& change : changes) {
    RenderPlan changed = asked;
    change(changed);
    EXPECT_THROW(render(subject, changed), UsageError);
  }
}

} // namespace
} // namespace wavepath::test
