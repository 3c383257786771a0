// Anti-aliasing: pictures of one colour, edges whose coverage is known, and what each technique must leave alone.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "host/base/error.h"
#include "host/integrators/hybrid/antialias/catalogue.h"
#include "host/render/settings/antialias_settings.h"
#include "tests/shadow_scene.h"

namespace wavepath::test {
namespace {

constexpr int kSide = 48; // pixels

RenderPlan antialias_settings(std::string_view technique, std::uint32_t samples = 1) {
  RenderPlan settings;
  settings.integrator = &kHybrid;
  settings.width = settings.height = kSide;
  settings.max_depth = 0; // light that is seen directly
  settings.filter = gpu::kFilterBox;
  settings.last_sample = samples;
  settings.antialias = index_of(kAntialiasTechniques.names(), technique);
  return settings;
}

// A plane that shines, as far as x * slope + height in pixels from the middle upwards; a pixel is a metre.
Scene half_plane(float slope, float height, glm::vec3 light = glm::vec3(1.0f)) {
  Scene scene;
  scene.path = "test";
  Material shining = plain_material();
  shining.emission = light;
  scene.materials.push_back(shining);
  const glm::vec3 a(-100, height - 100 * slope, 0), b(100, height + 100 * slope, 0), c(100, -400, 0), d(-100, -400, 0);
  add_instance(scene, add_mesh(scene, {a, d, c, a, c, b}));
  Camera camera;
  camera.orthographic = true;
  camera.xmag = camera.ymag = kSide / 2;
  camera.world_from_camera[3] = {0, 0, 10, 1};
  scene.cameras.push_back(camera);
  return scene;
}

// Of a pixel: the fraction of a grid of places below the edge.
double coverage(int x, int y, double slope, double height, int side) {
  int below = 0;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      below += kSide / 2 - (y + (j + 0.5) / side) < height + slope * (x + (i + 0.5) / side - kSide / 2);
  return static_cast<double>(below) / (side * side);
}

class AntialiasTest : public ShadowTest {
protected:
  // Root mean square of what a picture is away from the edge's coverage.
  static double error(const std::vector<float>& picture, double slope, double height) {
    double sum = 0.0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double off = picture[i] - coverage(i % kSide, i / kSide, slope, height, 32);
      sum += off * off;
    }
    return std::sqrt(sum / (kSide * kSide));
  }
};

TEST_F(AntialiasTest, OneColourStaysItself) {
  const glm::vec3 colour(0.3f, 1.7f, 5.1f);
  const Scene scene = half_plane(0.0f, 200.0f, colour);
  for (const std::string_view name : kAntialiasTechniques.names()) {
    const RenderPlan settings = antialias_settings(name, 16);
    const Picture picture = render(scene, settings).picture;
    // Areas of both triangles of the plane are rounded.
    const float rounding = kAntialiasTechniques.find(settings)->beam ? 1e-6f : 0.0f;
    for (int c = 0; c < 3; ++c)
      for (const float value : picture.channels[c].values) ASSERT_NEAR(value, colour[c], rounding * colour[c]) << name;
  }
}

TEST_F(AntialiasTest, NoneIsWhatTheCentreShows) {
  const std::vector<float> picture = light(half_plane(0.37f, 0.1f), antialias_settings("none", 2));
  for (int i = 0; i < kSide * kSide; ++i)
    ASSERT_EQ(picture[i], coverage(i % kSide, i / kSide, 0.37, 0.1, 1)) << i % kSide << "," << i / kSide;
}

TEST_F(AntialiasTest, SupersamplingIsTheFractionOfItsGrid) {
  for (const int side : {2, 4}) {
    const std::vector<float> picture = light(half_plane(0.37f, 0.1f), antialias_settings("supersample", side * side));
    for (int i = 0; i < kSide * kSide; ++i)
      ASSERT_EQ(picture[i], coverage(i % kSide, i / kSide, 0.37, 0.1, side)) << i % kSide << "," << i / kSide;
  }
}

TEST_F(AntialiasTest, FiltersOfEdgesLeaveTheRestAlone) {
  const Scene scene = half_plane(0.37f, 0.1f, glm::vec3(3.0f));
  const std::vector<float> plain = light(scene, antialias_settings("none"));
  for (const char* name : {"fxaa", "smaa"}) {
    const std::vector<float> picture = light(scene, antialias_settings(name));
    std::size_t changed = 0;
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const auto at = [&](int i, int j) {
          return plain[std::clamp(j, 0, kSide - 1) * kSide + std::clamp(i, 0, kSide - 1)];
        };
        const float here = at(x, y);
        const bool even = at(x - 1, y) == here && at(x + 1, y) == here && at(x, y - 1) == here && at(x, y + 1) == here;
        if (even) {
          ASSERT_EQ(picture[y * kSide + x], here) << name << x << "," << y;
        }
        changed += picture[y * kSide + x] != here;
      }
    EXPECT_GT(changed, 40u) << name;
  }
}

// Steps are best where they are longest; of the technique's error on an edge that rises one pixel in eight remains less
// than half, on steep ones less than three quarters.
TEST_F(AntialiasTest, FiltersOfEdgesBringThemNearerToTheirCoverage) {
  for (const char* name : {"fxaa", "smaa"})
    for (const auto& [slope, fraction] :
         {std::pair(0.125f, 0.5), std::pair(0.2f, 0.5), std::pair(0.37f, 0.75), std::pair(3.1f, 0.75)}) {
      const Scene scene = half_plane(slope, 0.3f);
      const double before = error(light(scene, antialias_settings("none")), slope, 0.3),
                   after = error(light(scene, antialias_settings(name)), slope, 0.3);
      EXPECT_LT(after, fraction * before) << name << " " << slope;
    }
}

// Where the line crosses the middle of each step, the one that SMAA draws is that line.
TEST_F(AntialiasTest, SmaaOfARegularStairIsItsLine) {
  constexpr float kSlope = 0.125f, kHeight = 0.5f;
  const std::vector<float> picture = light(half_plane(kSlope, kHeight), antialias_settings("smaa"));
  for (int y = 0; y < kSide; ++y)
    for (int x = 8; x < kSide - 8; ++x) // the ends of the first and last steps lie outside
      EXPECT_NEAR(picture[y * kSide + x], coverage(x, y, kSlope, kHeight, 64), 0.01) << x << "," << y;
}

TEST_F(AntialiasTest, SmaaLeavesStraightEdgesAlone) {
  const Scene scene = half_plane(0.0f, 0.3f);
  EXPECT_EQ(light(scene, antialias_settings("smaa")), light(scene, antialias_settings("none")));
}

// Light that is the same all over a triangle does not ask where it is found.
TEST_F(AntialiasTest, MultisamplingIsSupersamplingOfConstantLight) {
  Scene scene = half_plane(0.37f, 0.1f, {0.3f, 0.7f, 2.9f});
  Material other = plain_material();
  other.emission = {1.3f, 0.1f, 0.6f};
  scene.materials.push_back(other);
  for (int i = -4; i < 5; ++i) // narrow, so that pixels show three things and more
    add_instance(scene, add_mesh(scene, rectangle({4.3f * i, 0.2f * i, 1}, {0.3f, 20, 0}, {-0.4f, 0.1f, 0}), 1));
  for (const std::uint32_t samples : {4u, 8u}) {
    const Picture grid = render(scene, antialias_settings("supersample", 4)).picture,
                  picture = render(scene, antialias_settings("msaa", samples)).picture;
    for (int c = 0; c < 3; ++c) ASSERT_EQ(picture.channels[c].values, grid.channels[c].values) << samples;
  }
}

// Inside a triangle there is one result of shading a pixel, that of its centre; supersampling finds another one at
// every place. The lamp is so near that light bends within a pixel.
TEST_F(AntialiasTest, MultisamplingShadesATriangleOncePerPixel) {
  Scene scene = half_plane(0.0f, 200.0f);
  scene.materials[0].emission = glm::vec3(0.0f);
  scene.lights.push_back(lamp({3.0, 2.0, 1.5}));
  const auto picture_of = [&](const char* name, std::uint32_t samples) {
    RenderPlan settings = antialias_settings(name, samples);
    settings.max_depth = 1;
    settings.direct = gpu::kDirectNee;
    return light(scene, settings);
  };
  const std::vector<float> msaa = picture_of("msaa", 4), csaa = picture_of("csaa", 16), centre = picture_of("none", 1),
                           grid = picture_of("supersample", 4);
  std::size_t once = 0, differs = 0;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const int i = y * kSide + x;
      once += std::abs(msaa[i] - centre[i]) <= 1e-6f * centre[i] && std::abs(csaa[i] - centre[i]) <= 1e-6f * centre[i];
      differs += std::abs(grid[i] - centre[i]) > 1e-4f * centre[i];
    }
  // Pixels on the diagonal between the two triangles are shaded twice, at the same centre.
  EXPECT_EQ(once, msaa.size());
  EXPECT_GT(differs, msaa.size() / 8);
}

// What MSAA is known to do: what shading itself makes, such as the edge of a shadow, stays a stair.
TEST_F(AntialiasTest, MultisamplingLeavesEdgesOfShadowsAlone) {
  Scene scene = half_plane(0.0f, 200.0f);
  scene.materials[0].emission = glm::vec3(0.0f);
  scene.lights.push_back(sun({0.0, 0.0, -1.0}));
  add_instance(scene, add_mesh(scene, rectangle({0, -30, 20}, {100, 37, 0}, {0, 30, 0}))); // behind the camera
  const auto levels = [&](const char* name) {
    RenderPlan settings = antialias_settings(name, 4);
    settings.max_depth = 1;
    settings.direct = gpu::kDirectNee;
    std::vector<float> values = light(scene, settings);
    const float most = *std::ranges::max_element(values);
    return std::ranges::count_if(values, [&](float v) { return v > 0.01f * most && v < 0.99f * most; });
  };
  EXPECT_EQ(levels("msaa"), 0);
  EXPECT_GT(levels("supersample"), kSide / 2);
}

// Sixteen places of coverage: upright and level edges err by half a place, whatever their height; slanted ones by two.
TEST_F(AntialiasTest, CoverageSamplesTellEdgesToASixteenth) {
  for (const float height : {0.02f, 0.26f, 0.47f, 0.7f, 0.94f}) {
    const std::vector<float> level = light(half_plane(0.0f, height), antialias_settings("csaa", 16));
    const int row = kSide / 2 - 1; // the pixels that the edge crosses
    for (int x = 0; x < kSide; ++x) EXPECT_NEAR(level[row * kSide + x], height, 0.5 / 16 + 1e-6) << height;
    for (const float slope : {0.37f, 1.9f}) {
      const std::vector<float> slanted = light(half_plane(slope, height), antialias_settings("csaa", 16));
      for (int i = 0; i < kSide * kSide; ++i)
        EXPECT_NEAR(slanted[i], coverage(i % kSide, i / kSide, slope, height, 64), 2.0 / 16) << i << " " << slope;
    }
  }
}

// Light for pixels to the right of x = 0, in front of a plane that shines as well: it grows at each of the upright
// edges between these pixels' strips of equal width. Every strip is one triangle.
Scene strips(const std::vector<float>& lights) {
  Scene scene = half_plane(0.0f, 200.0f, glm::vec3(lights.front()));
  for (std::size_t i = 1; i < lights.size(); ++i) {
    Material material = plain_material();
    material.emission = glm::vec3(lights[i]);
    scene.materials.push_back(material);
    const float x = static_cast<float>(i) / static_cast<float>(lights.size()), z = 0.1f * static_cast<float>(i);
    add_instance(scene, add_mesh(scene, {{x, -400, z}, {x + 400, 0, z}, {x, 400, z}}, static_cast<std::uint32_t>(i)));
  }
  return scene;
}

// Four triangles in a pixel have colours of their own. Later ones take the last of these: what is seen of them stays
// within the light that is there.
TEST_F(AntialiasTest, CoverageSamplesKeepTheColoursOfFourTriangles) {
  const auto first_pixels = [&](const std::vector<float>& lights) {
    const std::vector<float> picture = light(strips(lights), antialias_settings("csaa", 16));
    for (int y = 0; y < kSide; ++y) EXPECT_EQ(picture[y * kSide + kSide / 2], picture[kSide / 2]) << y;
    return picture[kSide / 2];
  };
  EXPECT_FLOAT_EQ(first_pixels({0, 1, 2, 4}), 7.0f / 4);
  EXPECT_FLOAT_EQ(first_pixels({1, 1.5f, 2, 2.5f, 3, 3.5f, 4, 4.5f}), (1 + 1.5f + 2 + 5 * 2.5f) / 8);
}

// ---- beams and cones --------------------------------------------------------------------------------------------

using Corners = std::vector<glm::dvec2>;

// The part of a convex polygon on the side of a line where dot(normal, p) <= limit.
Corners cut(const Corners& polygon, glm::dvec2 normal, double limit) {
  Corners part;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    const double from = glm::dot(normal, a) - limit, to = glm::dot(normal, b) - limit;
    if (from <= 0.0) part.push_back(a);
    if ((from <= 0.0) != (to <= 0.0)) part.push_back(a + (b - a) * (from / (from - to)));
  }
  return part;
}

double area_of(const Corners& polygon) {
  double twice = 0.0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const glm::dvec2 a = polygon[i], b = polygon[(i + 1) % polygon.size()];
    twice += a.x * b.y - a.y * b.x;
  }
  return 0.5 * std::abs(twice);
}

// Of a square or a disc of area 1 around a point of the picture, in pixels from its middle, y upwards: the fraction
// below y = slope x + height.
double exact_coverage(bool is_disc, glm::dvec2 at, double slope, double height) {
  const glm::dvec2 normal(-slope, 1.0);
  const double limit = height - glm::dot(normal, at);
  if (!is_disc) return area_of(cut({{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}}, normal, limit));
  const double radius = 1.0 / std::sqrt(std::numbers::pi),
               distance = std::clamp(limit / glm::length(normal), -radius, radius);
  // 1 less the circular segment beyond the line.
  return 1.0 -
         (radius * radius * std::acos(distance / radius) - distance * std::sqrt(radius * radius - distance * distance));
}

glm::dvec2 middle_of_pixel(int i) { return {i % kSide + 0.5 - kSide / 2, kSide / 2 - (i / kSide + 0.5)}; }

// Adds a triangle that shines, at a depth.
void add_shining(Scene& scene, const std::array<glm::vec2, 3>& corners, float z, float light) {
  Material material = plain_material();
  material.emission = glm::vec3(light);
  scene.materials.push_back(material);
  std::vector<glm::vec3> placed;
  for (const glm::vec2& corner : corners) placed.emplace_back(corner, z);
  add_instance(scene, add_mesh(scene, placed, static_cast<std::uint32_t>(scene.materials.size() - 1)));
}

// The camera of half_plane(), and nothing else yet.
Scene nothing() {
  Scene scene;
  scene.path = "test";
  scene.cameras = half_plane(0.0f, 0.0f).cameras;
  return scene;
}

// half_plane() as far as the picture goes: floats place small bodies more exactly.
Scene small_half_plane(float slope, float height) {
  Scene scene = nothing();
  const glm::vec2 along = glm::normalize(glm::vec2(1.0f, slope)), down(along.y, -along.x), at(0.0f, height),
                  a = at - 36.0f * along, b = at + 36.0f * along, c = b + 50.0f * down, d = a + 50.0f * down;
  add_shining(scene, {a, d, c}, 0.0f, 1.0f);
  add_shining(scene, {a, c, b}, 0.0f, 1.0f);
  return scene;
}

TEST_F(AntialiasTest, BeamsAndConesCoverHalfPlanesExactly) {
  for (const char* name : {"beam", "cone"})
    for (const auto& [slope, height] : {std::pair(0.0f, 0.3f), std::pair(0.1f, -0.37f), std::pair(0.37f, 0.1f),
                                        std::pair(1.0f, 0.25f), std::pair(-1.9f, 0.7f), std::pair(3.1f, 0.02f)}) {
      const std::vector<float> picture = light(small_half_plane(slope, height), antialias_settings(name, 4));
      for (int i = 0; i < kSide * kSide; ++i)
        ASSERT_NEAR(picture[i], exact_coverage(*name == 'c', middle_of_pixel(i), slope, height), 1e-5)
            << name << " " << slope << " pixel " << i % kSide << "," << i / kSide;
    }
}

// A camera at a height above the plane that shines, which it looks at from straight above; a pixel of the plane is a
// metre as in half_plane().
Camera perspective_above(double height) {
  Camera camera;
  camera.yfov = 2.0 * std::atan(kSide / 2 / height);
  camera.world_from_camera[3] = {0, 0, height, 1};
  return camera;
}

TEST_F(AntialiasTest, BeamsAndConesFindTrianglesSmallerThanAPixel) {
  const std::array<glm::vec2, 3> corners = {{{3.3f, 5.42f}, {3.55f, 5.37f}, {3.41f, 5.63f}}};
  const double area = area_of({corners[0], corners[1], corners[2]});
  for (const bool is_perspective : {false, true})
    for (const char* name : {"beam", "cone"}) {
      Scene scene = nothing();
      if (is_perspective) scene.cameras = {perspective_above(40.0)};
      add_shining(scene, corners, 0.0f, 1.0f);
      const std::vector<float> picture = light(scene, antialias_settings(name, 4));
      for (int i = 0; i < kSide * kSide; ++i) {
        const bool holds_it = i == (kSide / 2 - 6) * kSide + kSide / 2 + 3;
        ASSERT_NEAR(picture[i], holds_it ? area : 0.0, 1e-6) << name << " pixel " << i;
      }
    }
}

// In a pixel of a plane: two triangles before each other, the nearer of which lets a part of the farther be seen.
TEST_F(AntialiasTest, BeamsAndConesSeeTheNearestOfTriangles) {
  const double slopes[2] = {0.37, -0.9}, heights[2] = {0.3, 0.1};
  for (const bool nearer : {false, true})
    for (const char* name : {"beam", "cone"}) {
      Scene scene = half_plane(0.0f, 200.0f, glm::vec3(0.25f));
      for (int i = 0; i < 2; ++i) {
        const auto y = [&](double x) { return static_cast<float>(slopes[i] * x + heights[i]); };
        add_shining(scene, {{{-90, y(-90)}, {90, y(90)}, {0, -300}}}, (i == 0) == nearer ? 1.0f : 2.0f, i == 0 ? 1 : 2);
      }
      const std::vector<float> picture = light(scene, antialias_settings(name, 4));
      for (int i = 0; i < kSide * kSide; ++i) {
        const glm::dvec2 at = middle_of_pixel(i);
        if (std::abs(at.x) > 12.0 || std::abs(at.y) > 12.0) continue; // other edges
        const auto below = [&](int k) { return exact_coverage(*name == 'c', at, slopes[k], heights[k]); };
        const int front = nearer ? 1 : 0, back = 1 - front;
        // The square, or a polygon that is nearly the disc.
        Corners shape = {{-0.5, -0.5}, {0.5, -0.5}, {0.5, 0.5}, {-0.5, 0.5}};
        if (*name == 'c') {
          shape.clear();
          for (int k = 0; k < 1024; ++k)
            shape.push_back(
                glm::dvec2(std::cos(k * 2.0 * std::numbers::pi / 1024), std::sin(k * 2.0 * std::numbers::pi / 1024)) /
                std::sqrt(std::numbers::pi));
        }
        for (int k = 0; k < 2; ++k) {
          const glm::dvec2 normal(-slopes[k], 1.0);
          shape = cut(shape, normal, heights[k] - glm::dot(normal, at));
        }
        const double lights[2] = {1.0, 2.0}, of_front = below(front), of_back = below(back) - area_of(shape);
        ASSERT_NEAR(picture[i], lights[front] * of_front + lights[back] * of_back + 0.25 * (1.0 - of_front - of_back),
                    2e-5)
            << name << " pixel " << i;
      }
    }
}

// Four parts of a pixel have lights of their own, and share what others cover.
TEST_F(AntialiasTest, BeamsKeepTheFourLargestPartsOfAPixel) {
  const auto first_pixel = [&](const std::vector<float>& lights) {
    return light(strips(lights), antialias_settings("beam", 4))[kSide / 2 * kSide + kSide / 2];
  };
  EXPECT_NEAR(first_pixel({0, 1, 2, 4}), 7.0 / 4, 1e-4);
  const float eight = first_pixel({1, 1.5f, 2, 2.5f, 3, 3.5f, 4, 4.5f});
  EXPECT_GE(eight, 1.75f - 1e-4f);
  EXPECT_LE(eight, 3.75f + 1e-4f);
  std::vector<float> many; // more than a beam has room for
  for (int i = 0; i < 30; ++i) many.push_back(1.0f + 0.1f * static_cast<float>(i));
  EXPECT_GE(first_pixel(many), 1.0f);
  EXPECT_LE(first_pixel(many), 4.0f);
}

// Bodies in perspective, by instances and with backs that are not seen: nearer to many samples than sixteen places.
TEST_F(AntialiasTest, BeamsAreNearerToSupersamplingThanCoverageSamples) {
  Scene scene = bodies();
  scene.materials.push_back(scene.materials[0]);
  scene.materials[0].emission = glm::vec3(0.2f);
  scene.materials[1].emission = glm::vec3(1.0f);
  for (std::size_t i = 1; i < scene.meshes.size(); ++i) scene.meshes[i].primitives[0].material = 1;
  const auto picture_of = [&](const char* name, std::uint32_t samples) {
    return light(scene, antialias_settings(name, samples));
  };
  const std::vector<float> truth = picture_of("supersample", 1024);
  const auto error_of = [&](const char* name, std::uint32_t samples) {
    const std::vector<float> picture = picture_of(name, samples);
    double sum = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) sum += (picture[i] - truth[i]) * (picture[i] - truth[i]);
    return std::sqrt(sum / static_cast<double>(truth.size()));
  };
  const double beams = error_of("beam", 4), coverage_samples = error_of("csaa", 16);
  EXPECT_GT(coverage_samples, 1e-4);
  EXPECT_LT(beams, 0.5 * coverage_samples);
}

// A render may end at any frame: each shows the whole of a pixel that one triangle covers. Of two parts the larger one,
// f, has two frames up to f = 2/3, and then three: a first frame of weight 2 f errs by f, or one of 4/3 f by less.
TEST_F(AntialiasTest, AnyNumberOfFramesOfBeamsIsNearlyRight) {
  Scene scene = nothing();
  add_shining(scene, {{{-40, -11.3f}, {40, 17.9f}, {0, -70}}}, 0.0f, 1.0f);
  const std::vector<float> four = light(scene, antialias_settings("beam", 4));
  for (const std::uint32_t frames : {1u, 2u, 3u, 5u}) {
    const std::vector<float> picture = light(scene, antialias_settings("beam", frames));
    for (int i = 0; i < kSide * kSide; ++i) {
      const bool is_edge = four[i] > 1e-4f && four[i] < 1.0f - 1e-4f;
      ASSERT_NEAR(picture[i], four[i], is_edge ? 0.667f : 1e-4f) << frames << " frames, pixel " << i;
    }
  }
}

TEST_F(AntialiasTest, BeamsDoNotSeeBacks) {
  Scene scene = half_plane(0.37f, 0.1f);
  scene.materials[0].double_sided = false;
  const std::vector<float> front = light(scene, antialias_settings("beam", 4));
  EXPECT_EQ(front, light(half_plane(0.37f, 0.1f), antialias_settings("beam", 4)));
  scene.cameras[0].world_from_camera = {{-1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, -1, 0}, {0, 0, -10, 1}};
  for (const float value : light(scene, antialias_settings("beam", 4))) ASSERT_EQ(value, 0.0f);
}

TEST_F(AntialiasTest, HowBeamsAreCutUpDoesNotMatter) {
  Scene scene = lit_by(sun());
  RenderPlan settings = antialias_settings("beam", 8);
  settings.max_depth = 1;
  const std::vector<float> whole = light(scene, settings);
  settings.wave_slots = 700;
  EXPECT_EQ(light(scene, settings), whole);
}

// What FXAA is known to do: it softens edges that need nothing.
TEST_F(AntialiasTest, FxaaSoftensStraightEdges) {
  const Scene scene = half_plane(0.0f, 0.3f);
  EXPECT_NE(light(scene, antialias_settings("fxaa")), light(scene, antialias_settings("none")));
}

// Nor does a filter know what no centre shows: a line a fifth of a pixel wide comes in pieces.
TEST_F(AntialiasTest, FiltersDoNotFindWhatCentresMiss) {
  Scene scene = half_plane(0.0f, -300.0f);
  add_instance(scene, add_mesh(scene, rectangle({0, 0.1f, 0}, {100, 3, 0}, {0, 0.1f, 0})));
  const std::vector<float> fine = light(scene, antialias_settings("supersample", 256));
  for (const char* name : {"none", "fxaa", "smaa"}) {
    const std::vector<float> picture = light(scene, antialias_settings(name));
    int gaps = 0;
    for (int x = 0; x < kSide; ++x) {
      float column = 0.0f, truth = 0.0f;
      for (int y = 0; y < kSide; ++y) column += picture[y * kSide + x], truth += fine[y * kSide + x];
      EXPECT_GT(truth, 0.1f);
      gaps += column == 0.0f;
    }
    EXPECT_GT(gaps, kSide / 2) << name;
  }
}

// A still camera's frames are places of the pixel filter: of a box, the coverage.
TEST_F(AntialiasTest, TaaTendsToSupersampling) {
  const Scene scene = half_plane(0.37f, 0.1f, glm::vec3(0.5f));
  const std::vector<float> grid = light(scene, antialias_settings("supersample", 256));
  const auto distance = [&](const char* name, std::uint32_t samples) {
    const std::vector<float> picture = light(scene, antialias_settings(name, samples));
    double sum = 0.0;
    for (std::size_t i = 0; i < grid.size(); ++i) sum += (picture[i] - grid[i]) * (picture[i] - grid[i]);
    return std::sqrt(sum / static_cast<double>(grid.size()));
  };
  const double one = distance("taa", 1), many = distance("taa", 64), none = distance("none", 1);
  EXPECT_LT(many, 0.25 * one);
  EXPECT_LT(many, 0.25 * none);
}

// A square for each pixel, whose light has no order.
Scene mosaic() {
  constexpr int kKinds = 8;
  Scene scene = half_plane(0.0f, 200.0f);
  std::vector<std::vector<glm::vec3>> squares(kKinds);
  std::uint32_t random = 1;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      random = random * 1664525u + 1013904223u;
      const auto square = rectangle({x + 0.5f - kSide / 2, y + 0.5f - kSide / 2, 1}, {0.5f, 0, 0}, {0, 0.5f, 0});
      auto& kind = squares[random >> 29];
      kind.insert(kind.end(), square.begin(), square.end());
    }
  for (int i = 0; i < kKinds; ++i) {
    Material material = plain_material();
    material.emission = glm::vec3(1.0f + static_cast<float>(i));
    scene.materials.push_back(material);
    add_instance(scene, add_mesh(scene, squares[i], static_cast<std::uint32_t>(i + 1)));
  }
  return scene;
}

// A box filter stays within its pixel, so that every frame of whole size is the same picture; from the fourth one on,
// upscaled frames are it.
TEST_F(AntialiasTest, UpscalingOfAStillCameraTendsToTheWholePicture) {
  const Scene scene = mosaic();
  const std::vector<float> whole = light(scene, antialias_settings("filter", 1));
  ASSERT_EQ(whole, light(scene, antialias_settings("filter", 4)));
  const std::vector<float> one = light(scene, antialias_settings("upscale", 1)),
                           four = light(scene, antialias_settings("upscale", 4)),
                           twelve = light(scene, antialias_settings("upscale", 12));
  std::size_t seen = 0;
  for (std::size_t i = 0; i < whole.size(); ++i) {
    ASSERT_NEAR((12 * twelve[i] - 4 * four[i]) / 8, whole[i], 1e-4) << i;
    ASSERT_LE(std::abs(twelve[i] - whole[i]), 3.0f / 12 * 7) << i;
    seen += one[i] == whole[i];
  }
  EXPECT_GE(seen, whole.size() / 4);
  EXPECT_LT(seen, whole.size() / 2);
}

// Every fourth pixel is seen and shaded, whatever the size.
TEST_F(AntialiasTest, UpscalingShadesAQuarterOfThePixels) {
  Scene scene = half_plane(0.0f, 200.0f);
  scene.materials[0].emission = glm::vec3(0.0f);
  scene.lights.push_back(lamp({3.0, 2.0, 1.5}));
  for (const std::uint32_t side : {48u, 37u}) {
    const auto shadow_rays = [&](const char* name) {
      RenderPlan settings = antialias_settings(name, 4);
      settings.width = settings.height = side;
      settings.max_depth = 1;
      settings.direct = gpu::kDirectNee;
      return render(scene, settings).rays.shadow;
    };
    EXPECT_EQ(shadow_rays("filter"), 4 * side * side);
    EXPECT_EQ(shadow_rays("upscale"), 4 * ((side + 1) / 2) * ((side + 1) / 2));
  }
}

// Pixels by which a picture lies to the right of another one, and below it: by least squares from the slopes of that.
glm::dvec2 shift_between(const std::vector<float>& a, const std::vector<float>& b, int width, int height) {
  glm::dvec2 sum(0.0), squares(0.0);
  for (int y = 2; y + 2 < height; ++y)
    for (int x = 2; x + 2 < width; ++x) {
      const int i = y * width + x;
      const glm::dvec2 slope = 0.5 * glm::dvec2(a[i + 1] - a[i - 1], a[i + width] - a[i - width]);
      sum += static_cast<double>(a[i] - b[i]) * slope;
      squares += slope * slope;
    }
  return sum / squares;
}

// Light of odd and even sizes lies where it lies in a whole frame. The frames that see a pixel have its positions, but
// for a few of them, so that their mean may be a tenth of a pixel away.
TEST_F(AntialiasTest, UpscaledFramesShowTheSameView) {
  Scene scene = half_plane(0.0f, 200.0f);
  scene.materials[0].emission = glm::vec3(0.0f);
  scene.lights.push_back(lamp({3.0, 2.0, 9.5}));
  for (const int side : {48, 37})
    for (const std::uint32_t first_hit : {kFirstHitTraced, kFirstHitRaster}) {
      const auto picture = [&](const char* name) {
        RenderPlan settings = antialias_settings(name, 32);
        settings.width = side, settings.height = side + 3;
        settings.max_depth = 1;
        settings.direct = gpu::kDirectNee;
        settings.first_hit = first_hit;
        return light(scene, settings);
      };
      const glm::dvec2 shift = shift_between(picture("filter"), picture("upscale"), side, side + 3);
      EXPECT_NEAR(shift.x, 0.0, 0.1) << side;
      EXPECT_NEAR(shift.y, 0.0, 0.1) << side;
    }
}

// What else filters frames does so before: all of it keeps one colour.
TEST_F(AntialiasTest, UpscalingGoesWithOtherFilters) {
  Scene scene = half_plane(0.0f, 200.0f);
  const auto expect_one = [&](const Scene& shown, const std::function<void(RenderPlan&)>& change) {
    RenderPlan settings = antialias_settings("upscale", 5);
    change(settings);
    for (const float value : light(shown, settings)) ASSERT_NEAR(value, 1.0f, 1e-5f);
  };
  expect_one(scene, [](RenderPlan& s) { s.denoise = kDenoiseOn; });
  expect_one(scene, [](RenderPlan& s) { s.lens = {.aperture = 0.5, .focus = 3.0}; });
  expect_one(scene, [](RenderPlan& s) { s.transparency = 1; });
  Mesh& mesh = scene.meshes[0];
  mesh.end_positions = mesh.positions;
  for (glm::vec3& p : mesh.end_positions) p.x += 9.0f;
  expect_one(scene, [](RenderPlan& s) { s.moving = true; });
}

TEST_F(AntialiasTest, OcclusionHasEdgesToo) {
  const Scene scene = half_plane(0.125f, 0.5f);
  const auto error_of = [&](const char* name) {
    RenderPlan settings = antialias_settings(name);
    settings.integrator = &kAo;
    return error(light(scene, settings), 0.125, 0.5);
  };
  EXPECT_LT(error_of("smaa"), 0.5 * error_of("none"));
}

TEST_F(AntialiasTest, FiltersRunWhereTheyAreAskedForAndSayWhatTheyTake) {
  const Scene scene = half_plane(0.37f, 0.1f);
  for (const AntialiasKind* kind : kAntialiasTechniques.rows) {
    const RenderPlan settings = antialias_settings(kind->name, 16);
    const RenderResult result = render(scene, settings);
    const bool runs = std::ranges::count(result.stages, "anti-aliasing", &StageTime::name) > 0;
    EXPECT_EQ(runs, !kind->passes.empty() || kind->over_time || kind->beam) << kind->name;
    EXPECT_EQ(result.antialias.has_value(), runs) << kind->name;
    if (runs) {
      EXPECT_GT(result.antialias->median, 0.0);
    }
    const std::vector<std::string> bias = kHybrid.bias(settings, result);
    const auto names_it = [&](const std::string& text) { return text.find("--antialias") != std::string::npos; };
    EXPECT_EQ(std::ranges::any_of(bias, names_it), kind->is_biased) << kind->name;
  }
}

TEST(AntialiasSettings, EveryNameHasATechniqueAndRefusesWhatDoesNotFit) {
  expect_names_of_own(kAntialiasTechniques);
  EXPECT_EQ(kAntialiasTechniques.names()[kAntialiasTaaName], "taa");
  EXPECT_EQ(kAntialiasTechniques.names()[kAntialiasUpscaleName], "upscale");
  EXPECT_NO_THROW(check_antialias_settings(antialias_settings("supersample", 16)));
  EXPECT_THROW(check_antialias_settings(antialias_settings("supersample", 15)), UsageError);
  EXPECT_NO_THROW(check_antialias_settings(antialias_settings("msaa", 8)));
  EXPECT_THROW(check_antialias_settings(antialias_settings("msaa", 6)), UsageError);
  EXPECT_NO_THROW(check_antialias_settings(antialias_settings("csaa", 32)));
  EXPECT_THROW(check_antialias_settings(antialias_settings("csaa", 8)), UsageError);
  EXPECT_THROW(check_antialias_settings(antialias_settings("beam", 6)), UsageError);
  EXPECT_NO_THROW(kHybrid.check(antialias_settings("cone", 8)));
  RenderPlan parts = antialias_settings("beam", 4);
  parts.denoise = kDenoiseOn;
  EXPECT_THROW(kHybrid.check(parts), UsageError);
  parts = antialias_settings("cone", 4);
  parts.aovs = {"depth"};
  EXPECT_THROW(kHybrid.check(parts), UsageError);
  RenderPlan settings = antialias_settings("msaa", 4);
  settings.target_error = 0.1;
  EXPECT_THROW(check_antialias_settings(settings), UsageError);
  settings = antialias_settings("upscale", 3);
  EXPECT_NO_THROW(check_antialias_settings(settings));
  settings.aovs = {"depth"};
  EXPECT_THROW(check_antialias_settings(settings), UsageError);
  settings = antialias_settings("none");
  settings.filter = gpu::kFilterGaussian;
  EXPECT_THROW(check_antialias_settings(settings), UsageError);
}

} // namespace
} // namespace wavepath::test
