// Cameras that move nearly as fast as light: directions, brightness and colours against closed forms, and all that
// belongs to a picture beside its light.
#include <cmath>
#include <numbers>

#include "host/integrators/path/paths.h"
#include "host/integrators/whitted/kind.h"
#include "host/picture/files/picture_io.h"
#include "tests/bidirectional_scene.h"

namespace wavepath::test {
namespace {

constexpr double kPi = std::numbers::pi;

struct Motion {
  glm::dvec3 axis;
  double speed;
  double gamma() const { return 1.0 / std::sqrt(1.0 - speed * speed); }
  double doppler(const glm::dvec3& seen) const { return 1.0 / (gamma() * (1.0 - speed * glm::dot(axis, seen))); }
};
const Motion kMotion = {glm::normalize(glm::dvec3(0.4, 0.2, -1.0)), 0.6};

// All directions, the middle of the picture along -Z.
ViewRequest sphere_of(const Motion& motion) {
  return {.eye = glm::dvec3(0.0),
          .look_at = glm::dvec3(0.0, 0.0, -1.0),
          .projection = Projection::equirectangular,
          .velocity = motion.speed * motion.axis};
}
glm::dvec3 direction_of(double x, double y, double width, double height) {
  const double azimuth = 2.0 * kPi * (x / width - 0.5), elevation = kPi * (0.5 - y / height);
  return {std::cos(elevation) * std::sin(azimuth), std::sin(elevation), -std::cos(elevation) * std::cos(azimuth)};
}

// The channel c at wavelength D w, as docs/cameras_and_passes.md states it.
double shifted(const glm::dvec3& radiance, int c, double doppler) {
  const double w[] = {464.2, 549.1, 611.4}, values[] = {radiance.b, radiance.g, radiance.r};
  const double at = doppler * w[2 - c];
  double value = values[0];
  for (int i = 0; i < 2; ++i)
    if (at > w[i]) value = values[i] + (values[i + 1] - values[i]) * std::min(1.0, (at - w[i]) / (w[i + 1] - w[i]));
  return std::pow(doppler, 5) * value;
}

class Relativity : public BidirectionalTest {
protected:
  static Scene sky(const glm::vec3& radiance) {
    Scene scene;
    scene.path = "test";
    scene.materials.push_back(plain_material());
    add_instance(scene, add_mesh(scene, quad({-1, -9e3f, -1}, {1, -9e3f, -1}, {1, -9e3f, 1}, {-1, -9e3f, 1})));
    scene.environment.radiance = radiance;
    return scene;
  }
};

// tan(a'/2) = tan(a/2) sqrt((1 - v) / (1 + v)), and cos a' = (cos a + v) / (1 + v cos a): where small lamps are seen.
TEST_F(Relativity, LampsAreSeenTowardsTheDirectionOfMotion) {
  const glm::dvec3 across = glm::normalize(glm::cross(kMotion.axis, glm::dvec3(0.0, 1.0, 0.0)));
  for (const double angle : {0.5, 1.3, 2.2}) {
    SCOPED_TRACE(angle);
    const glm::dvec3 towards = std::cos(angle) * kMotion.axis + std::sin(angle) * across;
    Scene scene;
    scene.path = "test";
    Material shining = plain_material();
    shining.emission = glm::vec3(1.0f);
    scene.materials.push_back(shining);
    const glm::vec3 centre(10.0 * towards),
        right = glm::vec3(glm::normalize(glm::cross(towards, {0, 1, 0}))) * 0.3f,
        up = glm::vec3(glm::normalize(glm::cross(glm::dvec3(right), towards))) * 0.3f;
    add_instance(scene, add_mesh(scene, quad(centre - right - up, centre + right - up, centre + right + up,
                                             centre - right + up)));
    RenderPlan asked = path_settings(16, 0);
    asked.width = 128, asked.height = 64;
    asked.filter = gpu::kFilterBox;
    for (const IntegratorKind* kind : {&kPath, &kWhitted, &kBidirectional}) {
      SCOPED_TRACE(kind->name);
      asked.integrator = kind;
      Subject subject(scene, asked);
      subject.view = resolve_view(scene, sphere_of(kMotion), asked.width, asked.height);
      const Picture picture = render(subject, asked).picture;
      glm::dvec3 seen(0.0);
      for (std::uint32_t i = 0; i < asked.width * asked.height; ++i)
        seen += double{picture.channels[0].values[i]} *
                direction_of(i % asked.width + 0.5, i / asked.width + 0.5, asked.width, asked.height);
      ASSERT_GT(glm::length(seen), 0.0);
      const double cosine =
          (std::cos(angle) + kMotion.speed) / (1.0 + kMotion.speed * std::cos(angle)); // Weiskopf 1999, equation 6
      const glm::dvec3 expected = cosine * kMotion.axis + std::sqrt(1.0 - cosine * cosine) * across;
      EXPECT_LT(glm::length(glm::normalize(seen) - expected), 0.015); // 0.3 pixels
    }
  }
}

// Pixel by pixel: D^5 for a colourless sky; for one of a colour by what its channels say of other wavelengths.
TEST_F(Relativity, ASkyOfOneColourIsAsTheFormulaSays) {
  for (const glm::vec3 radiance : {glm::vec3(1.0f), glm::vec3(0.9f, 0.1f, 0.4f)}) {
    const Scene scene = sky(radiance);
    RenderPlan asked = path_settings(1, 1);
    asked.width = 48, asked.height = 24;
    asked.filter = gpu::kFilterCentre;
    for (const IntegratorKind* kind : {&kPath, &kWhitted, &kBidirectional})
      for (const double speed : {0.3, 0.99}) {
        SCOPED_TRACE(testing::Message() << kind->name << ", " << speed);
        const Motion motion{kMotion.axis, speed};
        asked.integrator = kind;
        Subject subject(scene, asked);
        subject.view = resolve_view(scene, sphere_of(motion), asked.width, asked.height);
        const Picture picture = render(subject, asked).picture;
        for (std::uint32_t i = 0; i < asked.width * asked.height; ++i) {
          const double doppler =
              motion.doppler(direction_of(i % asked.width + 0.5, i / asked.width + 0.5, asked.width, asked.height));
          for (int c = 0; c < 3; ++c) {
            const double expected = shifted(glm::dvec3(radiance), c, doppler);
            ASSERT_NEAR(picture.channels[c].values[i], expected, 1e-4 * expected) << i << " channel " << c;
          }
        }
      }
  }
}

// All that a camera gets: the integral of D^5 over its sphere,
// pi / (2 v gamma^5) (1 / (1 - v)^4 - 1 / (1 + v)^4), which is 4 pi for v = 0.
TEST_F(Relativity, TheSphereGetsWhatTheIntegralSays) {
  const Scene scene = sky(glm::vec3(1.0f));
  RenderPlan asked = path_settings(16, 1);
  asked.width = 96, asked.height = 48;
  asked.filter = gpu::kFilterBox;
  Subject subject(scene, asked);
  subject.view = resolve_view(scene, sphere_of(kMotion), asked.width, asked.height);
  const Picture picture = render(subject, asked).picture;
  double sum = 0.0;
  for (std::uint32_t i = 0; i < asked.width * asked.height; ++i) {
    const double top = kPi * (0.5 - (i / asked.width) / 48.0), bottom = kPi * (0.5 - (i / asked.width + 1) / 48.0);
    sum += picture.channels[1].values[i] * 2.0 * kPi / asked.width * (std::sin(top) - std::sin(bottom));
  }
  const double v = kMotion.speed, expected = kPi / (2.0 * v * std::pow(kMotion.gamma(), 5)) *
                                             (std::pow(1.0 - v, -4) - std::pow(1.0 + v, -4));
  EXPECT_NEAR(sum, expected, 2e-3 * expected);
}

// Kernels of a camera at rest have no bit of it.
TEST_F(Relativity, ACameraAtRestHasTheBitsItHad) {
  Scene scene = corner();
  add_lamp(scene, LightKind::point);
  RenderPlan asked = path_settings(2, 2);
  Subject subject(scene, asked);
  const View at_rest = subject.view;
  subject.view = resolve_view(scene, {.velocity = glm::dvec3(0.0)}, asked.width, asked.height);
  EXPECT_EQ(needed_features(subject.packed, subject.view, asked) & gpu::kFeatureRelativity, 0u);
  EXPECT_EQ(needed_features(subject.packed, subject.view, asked) & gpu::kFeatureCameraModel, 0u);
  const RenderResult same = render(subject, asked);
  subject.view = at_rest;
  EXPECT_TRUE(*same.film == *render(subject, asked).film);
  subject.view.velocity = glm::dvec3(0.0, 0.0, -0.5);
  EXPECT_EQ(needed_features(subject.packed, subject.view, asked) & gpu::kFeatureRelativity, gpu::kFeatureRelativity);
  EXPECT_FALSE(*same.film == *render(subject, asked).film);
}

// Channels of the light add up to the picture, groups of lights as well, and the film is that of any waves.
TEST_F(Relativity, PartsOfTheLightAddUpToThePicture) {
  Scene scene = corner();
  add_lamp(scene, LightKind::point);
  add_shining_quad(scene, 2.5f);
  scene.environment.radiance = glm::vec3(0.2f, 0.3f, 0.5f);
  RenderPlan asked = path_settings(8, 3);
  asked.aovs = {"emission", "direct", "indirect"};
  Subject subject(scene, asked);
  subject.view.velocity = glm::dvec3(0.3, 0.1, -0.6);
  const RenderResult result = render(subject, asked);
  for (int c = 0; c < 3; ++c) {
    const std::string suffix = std::string(".") + "RGB"[c];
    double whole = 0.0;
    for (std::uint32_t i = 0; i < asked.width * asked.height; ++i) {
      const float expected = result.picture.channels[static_cast<std::size_t>(c)].values[i];
      float sum = 0.0f;
      for (const char* name : {"emission", "direct", "indirect"})
        sum += find_channel(result.picture, name + suffix)->values[i];
      ASSERT_NEAR(sum, expected, 1e-4f * expected + 1e-5f) << i << suffix;
      whole += expected;
    }
    EXPECT_GT(whole, 0.0);
  }
  asked.aovs.clear();
  expect_same_film_however_cut(subject, asked, *render(subject, asked).film);
}

// The interval holds the error of a picture whose brightness goes over orders of magnitude.
TEST_F(Relativity, TheErrorEstimateIsThatOfTheLightThatIsSeen) {
  Scene scene = corner();
  add_lamp(scene, LightKind::point);
  scene.environment.radiance = glm::vec3(0.4f, 0.5f, 0.7f);
  RenderPlan asked = path_settings(2048, 3);
  Subject subject(scene, asked);
  subject.view.velocity = glm::dvec3(0.3, 0.1, -0.6);
  const Picture reference = render(subject, asked).picture;
  asked.last_sample = 32;
  expect_intervals_cover(subject, reference, asked);
}

} // namespace
} // namespace wavepath::test
