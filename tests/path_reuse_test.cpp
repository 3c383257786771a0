// Reuse of paths: the same picture with it and without, whatever lies between the pixels and what their neighbours
// find; less noise; bits that do not depend on how the work is cut; where auto takes it; and an estimated error that is
// true.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/picture/metrics/metrics.h"
#include "host/plan/reuse.h"
#include "host/render/settings/path_reuse.h"
#include "tests/coverage.h"
#include "tests/light_rooms.h"
#include "tests/reuse_rooms.h"
#include "tests/statistics.h"

namespace wavepath::test {
namespace {

// The middle is between two columns of a quad, and the last tiles are cut off.
constexpr std::uint32_t kWidth = 22, kHeight = 15;
// Statistics of 16 differences follow Student's distribution with 15 degrees of freedom: z^2 is 15/13 on average, and
// one in 6000 is beyond 5.
constexpr std::uint32_t kSeeds = 16;
constexpr double kMeanSquare = 15.0 / 13.0, kFarOff = 5.0;

RenderPlan reusing(RenderPlan settings) {
  settings.reuse = kReuseOn;
  return settings;
}

RenderPlan apart(RenderPlan settings) {
  settings.reuse = kReuseOff;
  return settings;
}

RenderPlan split(RenderPlan settings) {
  settings.probes_from = std::numeric_limits<std::uint32_t>::max();
  return settings;
}

RenderPlan probed(RenderPlan settings) {
  settings.probes_from = 0;
  return settings;
}

// Rooms are seen from the front, unless `eye` says otherwise.
class PathReuse : public LightRooms {
protected:
  static RenderPlan asked(std::uint32_t spp = 16) {
    RenderPlan result = settings(gpu::kLightsPower, gpu::kDirectMis, spp);
    result.width = kWidth, result.height = kHeight;
    result.kernels.reuse = BearsReuse::anywhere; // with and without by the same kernels
    result.adaptive = kAdaptiveOff;
    return result;
  }
  static Subject room(Scene scene, const RenderPlan& settings, const glm::dvec3& eye = {0.0, 0.1, 1.9}) {
    ViewRequest request;
    request.eye = eye;
    request.look_at = glm::dvec3(0.0, -0.1, 0.0);
    request.yfov = eye.z > 2.0 ? 0.7 : 1.2;
    return {pack(scene, {.direct = settings.direct, .eye = request.eye, .lights = settings.lights}),
            resolve_view(scene, request, settings.width, settings.height)};
  }

  // What the picture with reuse has over that without, by seed. The two have their direct light in common, so that this
  // has less noise than either.
  void expect_same_picture(const char* name, const Subject& subject, const RenderPlan& settings, double shown);
};

// Sums over groups of values of one picture.
using Groups = std::vector<double>;

// Each pixel; squares of 4x4 pixels that cut through quads, by colour; columns of pixels, since walls are upright; the
// picture, by colour. What a quad shares out wrongly is no more and no less in the quad: it shows between its columns.
struct Grouping {
  std::size_t pixels, squares, columns, probed, all;
};
Grouping grouping(const RenderPlan& settings) {
  const std::size_t pixels = std::size_t{settings.width} * settings.height;
  const std::size_t squares = std::size_t{(settings.width + 6) / 4} * ((settings.height + 6) / 4);
  const std::size_t columns = pixels + 3 * squares;
  return {0, pixels, columns, columns + settings.width, columns + settings.width + 3};
}

Groups grouped(const Picture& picture, const RenderPlan& settings) {
  const Grouping at = grouping(settings);
  const std::size_t across = (settings.width + 6) / 4;
  Groups sums(at.all);
  for (std::size_t y = 0; y < settings.height; ++y)
    for (std::size_t x = 0; x < settings.width; ++x)
      for (std::size_t c = 0; c < 3; ++c) {
        const double value = picture.channels[c].values[y * settings.width + x];
        sums[at.pixels + y * settings.width + x] += value;
        sums[at.squares + 3 * ((y + 3) / 4 * across + (x + 3) / 4) + c] += value;
        sums[at.columns + x] += value;
        sums[at.probed + c] += value;
      }
  return sums;
}

// Squared differences over their squared errors, at most 25 each: few samples, some of which no path found bright.
double mean_square(const std::vector<Mean>& differences, std::size_t begin, std::size_t end, double least) {
  double sum = 0.0, judged = 0.0;
  for (std::size_t i = begin; i < end; ++i) {
    const double error = differences[i].error();
    if (!(error > least)) {
      EXPECT_LT(std::abs(differences[i].mean()), 1e-5 + least) << "group " << i << " differs without noise";
      continue;
    }
    sum += std::min(std::pow(differences[i].mean() / error, 2.0), 25.0), judged += 1.0;
  }
  return judged > 0.0 ? sum / judged : 0.0;
}

void PathReuse::expect_same_picture(const char* name, const Subject& subject, const RenderPlan& settings,
                                    double shown) {
  SCOPED_TRACE(name);
  const Grouping at = grouping(settings);
  std::vector<Mean> differences(at.all), sums(3);
  for (RenderPlan seeded = settings; seeded.seed < kSeeds; ++seeded.seed) {
    const Groups together = grouped(render(subject, reusing(seeded)).picture, settings),
                 alone = grouped(render(subject, apart(seeded)).picture, settings);
    for (std::size_t i = 0; i < at.all; ++i) differences[i].add(together[i] - alone[i]);
    for (std::size_t c = 0; c < 3; ++c) sums[c].add(alone[at.probed + c]);
  }
  const double pixels = mean_square(differences, at.pixels, at.squares, 1e-6),
               squares = mean_square(differences, at.squares, at.columns, 1e-6),
               columns = mean_square(differences, at.columns, at.probed, 1e-6);
  EXPECT_GT(pixels, 0.0) << "nothing was shared";
  // Values of a quad, and colours, are not independent: these are 5 standard deviations or more.
  EXPECT_LT(pixels, 1.6 * kMeanSquare);
  EXPECT_LT(squares, 2.2 * kMeanSquare);
  EXPECT_LT(columns, 3.0 * kMeanSquare);
  double seen = 0.0, off = 0.0;
  for (std::size_t c = 0; c < 3; ++c) {
    const Mean& difference = differences[at.probed + c];
    EXPECT_LT(std::abs(difference.mean()), kFarOff * difference.error() + 1e-5 * sums[c].mean()) << "colour " << c;
    seen = std::max(seen, kFarOff * difference.error() / sums[c].mean());
    off = std::max(off, std::abs(difference.mean()) / difference.error());
  }
  EXPECT_LT(seen, shown) << "too much noise to see a bias";
  RecordProperty(
      name, fmt::format("pixels {:.2f} squares {:.2f} columns {:.2f} sees {:.2g}", pixels, squares, columns, seen));
}

// ---- the same picture -----------------------------------------------------------------------------------------------

TEST_F(PathReuse, TheSamePictureOfADiffuseRoom) {
  for (const auto& [name, direct, light_samples] : {std::tuple{"mis", gpu::kDirectMis, 1u},
                                                    {"four light samples", gpu::kDirectMis, 4u},
                                                    {"nee", gpu::kDirectNee, 1u},
                                                    {"bsdf", gpu::kDirectBsdf, 1u}}) {
    RenderPlan settings = asked(32);
    settings.direct = direct, settings.light_samples = light_samples;
    expect_same_picture(name, room(parted_room(plain_material()), settings), settings, 0.01);
  }
}

// By a point light, which makes little noise, so that single pixels and columns tell 1 % of what a quad shares.
Scene point_lit(Scene scene) {
  scene.materials[3].emission = glm::vec3(0.0f); // a black screen
  PunctualLight lamp;
  lamp.intensity = glm::vec3(1.0f);
  lamp.position = {-1.0, 0.5, -0.8};
  scene.lights.push_back(lamp);
  return scene;
}

RenderPlan precise(RenderPlan settings, std::uint32_t spp = 256) {
  settings.last_sample = spp;
  settings.max_depth = 2;
  return settings;
}

TEST_F(PathReuse, TheSamePixelsWhereNeighboursSeeOtherThings) {
  const RenderPlan settings = precise(asked());
  expect_same_picture("screen", room(point_lit(parted_room(plain_material())), settings), settings, 0.001);
}

TEST_F(PathReuse, TheSamePictureUnderInterfaces) {
  Material rough = plain_material();
  rough.specular = 1.0f;
  rough.roughness = 0.3f;
  Material matt = rough, smooth = rough, infinite = rough, tint = rough, half = rough, metal = rough, dense = rough;
  matt.roughness = 1.0f;
  smooth.roughness = 0.0f;
  infinite.ior = 0.0f, infinite.specular = 0.5f;
  tint.specular_color = {2.0f, 0.5f, 0.1f}, tint.ior = 2.0f;
  half.metallic = 0.5f, half.roughness = 0.0f; // rough metal shares nothing: see may_reuse()
  metal.metallic = 1.0f;
  dense.ior = 3.0f, dense.roughness = 0.6f;
  const RenderPlan settings = asked();
  Scene both = parted_room(rough);
  both.materials[0] = plain_material();
  both.materials[1] = metal;
  for (const auto& [name, scene] : {std::pair{"roughness .3", parted_room(rough)},
                                    {"roughness 1", parted_room(matt)},
                                    {"smooth", parted_room(smooth)},
                                    {"infinite ior", parted_room(infinite)},
                                    {"tint", parted_room(tint)},
                                    {"half metallic", parted_room(half)},
                                    {"ior 3", parted_room(dense)},
                                    {"diffuse, dielectric and metal", both}})
    expect_same_picture(name, room(scene, settings), settings, 0.05);
  dense.roughness = 0.0f; // what passes depends most on the angle
  expect_same_picture("ior 3, precisely", room(point_lit(parted_room(dense)), precise(settings)), precise(settings),
                      0.05);
}

TEST_F(PathReuse, TheSamePictureOfBentNormals) {
  Material glossy = plain_material();
  glossy.specular = 1.0f;
  glossy.roughness = 0.5f;
  const RenderPlan settings = asked();
  for (const auto& [name, material, steepest] : {std::tuple{"glossy bumps", glossy, 0.6},
                                                 {"steep bumps", plain_material(), 1.3},
                                                 {"glossy steep bumps", glossy, 1.3}}) {
    Scene scene = parted_room(material);
    const TextureSlot bumps = add_bumps(scene, steepest);
    for (std::size_t i = 0; i < 2; ++i) scene.materials[i].normal_texture = bumps; // the right wall is even
    expect_same_picture(name, room(scene, settings), settings, 0.05);
  }
  Scene scene = point_lit(parted_room(plain_material()));
  const TextureSlot bumps = add_bumps(scene, 1.5);
  for (std::size_t i = 0; i < 3; ++i) scene.materials[i].normal_texture = bumps;
  expect_same_picture("steep bumps, precisely", room(scene, precise(settings)), precise(settings), 0.05);
}

TEST_F(PathReuse, TheSamePictureOfSmoothMeshes) {
  Scene scene = parted_room(plain_material());
  add_coarse_ball(scene, {-0.9f, -0.4f, -0.6f}, 0.55f, 0);
  add_coarse_ball(scene, {0.6f, 0.3f, 0.4f}, 0.5f, 2);
  RenderPlan settings = asked();
  for (const std::uint32_t terminator : {gpu::kTerminatorFacets, gpu::kTerminatorSmooth}) {
    settings.terminator = terminator;
    expect_same_picture(terminator == gpu::kTerminatorSmooth ? "smooth terminator" : "facets", room(scene, settings),
                        settings, 0.02);
  }
}

TEST_F(PathReuse, TheSamePictureOfLayers) {
  Scene scene = parted_room(plain_material());
  scene.materials[0].specular = 1.0f;
  scene.materials[0].roughness = 0.5f;
  Material layered = plain_material();
  layered.specular = 1.0f;
  Material coated = layered, velvet = layered, soap = layered, paper = layered;
  coated.coat = 0.8f, coated.coat_roughness = 0.2f;
  velvet.sheen_color = glm::vec3(0.7f), velvet.sheen_roughness = 0.5f;
  soap.iridescence = 1.0f;
  paper.diffuse_transmission = 0.6f;
  scene.materials[1] = coated;
  add_box(scene, {-1.7f, -1, 0}, {-1.0f, -0.4f, 0.5f}, add_material(scene, velvet));
  add_box(scene, {0.8f, -1, 0}, {1.5f, -0.5f, 0.6f}, add_material(scene, soap));
  add_wall(scene, {-0.9f, -1, -0.2f}, {0.7f, 0, 0.1f}, {0, 1.0f, 0}, add_material(scene, paper));
  const RenderPlan settings = asked();
  expect_same_picture("layers", room(scene, settings), settings, 0.05);
}

Material glass(const glm::vec3& tint) {
  Material result = plain_material();
  result.base_color = glm::vec4(tint, 1.0f);
  result.specular = 1.0f;
  result.roughness = 0.0f;
  result.transmission = 1.0f;
  return result;
}

TEST_F(PathReuse, TheSamePictureBehindGlass) {
  Material body = glass(glm::vec3(1.0f));
  body.volume = true;
  body.attenuation = {0.1f, 0.5f, 1.0f};
  Scene panes = parted_room(plain_material()), bodies = panes, both = panes;
  const auto add_pane = [](Scene& scene) {
    const std::uint32_t material = add_material(scene, glass({0.9f, 0.6f, 0.5f}));
    add_wall(scene, {-2, -1, -0.9f}, {1.9f, 0, 0}, {0, 1.4f, 0}, material);
    add_wall(scene, {0.2f, -0.7f, -0.4f}, {1.6f, 0, 0.5f}, {0, 0.3f, 1.0f}, material);
  };
  const auto add_body = [&](Scene& scene) {
    add_box(scene, {-1.3f, -0.95f, -0.3f}, {-0.6f, 0.2f, 0.3f}, add_material(scene, body));
  };
  add_pane(panes), add_body(bodies), add_pane(both), add_body(both);
  RenderPlan settings = asked();
  settings.max_depth = 4;
  expect_same_picture("panes", room(panes, settings), settings, 0.05);
  expect_same_picture("body", room(bodies, settings), settings, 0.05);
  expect_same_picture("panes and body", room(both, settings), settings, 0.05);
  // Panes seen edge on, each between two columns of a quad.
  Scene fins = point_lit(parted_room(plain_material()));
  const std::uint32_t material = add_material(fins, glass({0.5f, 0.9f, 0.9f}));
  for (const int column : {7, 9, 13, 15}) {
    const float slope = static_cast<float>((column - 11) * std::tan(0.6) / 7.5);
    add_wall(fins, {0.9f * slope, -1, 1.0f}, {2.9f * slope, 0, -2.9f}, {0, 2, 0}, material);
  }
  expect_same_picture("fins of glass", room(fins, precise(settings)), precise(settings), 0.05);
}

TEST_F(PathReuse, TheSamePictureBehindHoles) {
  Material blend = plain_material(), mask = plain_material(), unlit = plain_material();
  blend.base_color = {0.9f, 0.5f, 0.2f, 0.5f};
  blend.alpha_mode = AlphaMode::blend;
  mask.alpha_mode = AlphaMode::mask;
  unlit.unlit = true;
  Scene scene = parted_room(plain_material());
  std::vector<glm::vec4> checkers;
  for (int i = 0; i < 16; ++i) checkers.emplace_back(1.0f, 1.0f, 1.0f, (i + i / 4) % 2 ? 1.0f : 0.0f);
  mask.base_color_texture = add_image(scene, 4, checkers);
  add_wall(scene, {-2, -1, -0.9f}, {1.9f, 0, 0}, {0, 1.4f, 0}, add_material(scene, blend));
  add_wall(scene, {0.1f, -1, -0.9f}, {1.9f, 0, 0.8f}, {0, 1.2f, 0}, add_material(scene, mask));
  add_wall(scene, {0.2f, -0.8f, 0.5f}, {1.2f, 0, 0}, {0, 0.5f, 0}, add_material(scene, unlit));
  add_wall(scene, {-1.9f, -0.4f, -0.4f}, {1.2f, 0, 0.5f}, {0, 0.1f, 0.8f}, static_cast<std::uint32_t>(4)); // BLEND
  const RenderPlan settings = asked(32);
  expect_same_picture("holes", room(scene, settings), settings, 0.02);
}

// Seen from outside, through the backs of its walls.
TEST_F(PathReuse, TheSamePictureFromBehind) {
  Scene scene = parted_room(plain_material());
  for (std::size_t i = 0; i < 3; ++i) scene.materials[i].double_sided = false;
  for (const auto& [name, cull] :
       {std::pair{"for the camera", gpu::kCullCamera}, {"for all", gpu::kCullAll}, {"for none", gpu::kCullNone}}) {
    RenderPlan settings = asked();
    settings.cull = cull;
    const bool inside = cull == gpu::kCullNone;
    expect_same_picture(name, room(scene, settings, {0.0, 0.3, inside ? 1.9 : 4.5}), settings, 0.02);
  }
}

// Without a front wall.
Scene open_room(const Material& material) {
  Scene scene = parted_room(material);
  const Scene closed = scene;
  scene.instances.clear();
  for (const Instance& instance : closed.instances) {
    const auto& positions = closed.meshes[instance.mesh].positions;
    const bool front = std::all_of(positions.begin(), positions.end(), [](const auto& p) { return p.z == 2.0f; });
    if (!front) scene.instances.push_back(instance);
  }
  return scene;
}

TEST_F(PathReuse, TheSamePictureUnderTheSky) {
  Scene sky = open_room(plain_material()), map = sky;
  sky.environment.radiance = {0.8f, 1.0f, 1.2f};
  map.environment.radiance = glm::vec3(1.0f);
  map.environment.width = 8, map.environment.height = 4;
  for (int i = 0; i < 32; ++i) map.environment.map.emplace_back(i % 5 == 0 ? 3.0f : 0.2f);
  RenderPlan settings = asked();
  settings.light_samples = 1;
  expect_same_picture("map", room(map, settings), settings, 0.02);
  settings.light_samples = 4;
  expect_same_picture("map, four light samples", room(map, settings), settings, 0.02);
  settings.light_samples = 1;
  for (const std::uint32_t samples : {1u, 4u}) {
    settings.sky_samples = samples;
    expect_same_picture(samples == 1 ? "sky" : "sky, four samples", room(sky, settings), settings, 0.02);
  }
  settings.lights = gpu::kLightsAuto;
  expect_same_picture("sky, four learned samples", room(sky, settings), settings, 0.02);
}

TEST_F(PathReuse, TheSamePictureOfManyLights) {
  RenderPlan settings = asked();
  expect_same_picture("by power", subject(two_rooms(40, true), settings), settings, 0.05);
  settings.lights = gpu::kLightsAuto; // by a tree, and learned by a pilot
  settings.light_samples = 2;
  expect_same_picture("learned", subject(two_rooms(40, true), settings), settings, 0.05);
}

// Deep paths, which roulette ends, by independent samples.
TEST_F(PathReuse, TheSamePictureOfDeepPaths) {
  RenderPlan settings = asked();
  settings.max_depth = 12;
  settings.sampler = gpu::kSamplerIndependent;
  Material glossy = plain_material();
  glossy.specular = 1.0f;
  glossy.roughness = 0.4f;
  glossy.base_color = glm::vec4(glm::vec3(0.6f), 1.0f);
  expect_same_picture("deep", room(parted_room(glossy), settings), settings, 0.05);
}

// A room that glows, of which every path brings 1 - albedo^(D+1): four pixels share it out among them, and lose
// nothing. Two bounces, before roulette begins.
TEST_F(PathReuse, AGlowingRoomKeepsItsLight) {
  Scene scene;
  scene.path = "glowing room";
  Material wall = plain_material();
  wall.emission = glm::vec3(0.5f);
  scene.materials = {wall};
  add_box(scene, {-2, -1, -2}, {2, 1, 2}, 0, true);
  add_box(scene, {-0.06f, -1, -2}, {0.06f, 1, 0.2f}, 0);
  RenderPlan settings = reusing(asked(64));
  settings.width = settings.height = 16;
  settings.direct = gpu::kDirectBsdf;
  settings.max_depth = 2;
  const std::vector<float> red = render(room(scene, settings), settings).picture.channels[0].values;
  constexpr double kExact = 1.0 - 0.125;
  double squares = 0.0;
  for (std::size_t y = 0; y < 16; y += 2)
    for (std::size_t x = 0; x < 16; x += 2) {
      double quad = 0.0;
      for (const std::size_t i : {0, 1, 16, 17}) {
        const double value = red[y * 16 + x + i];
        quad += 0.25 * value, squares += std::pow(value - kExact, 2) / 256.0;
      }
      EXPECT_NEAR(quad, kExact, 1e-5) << x << ", " << y;
    }
  EXPECT_GT(squares, 1e-8) << "nothing was shared";
  EXPECT_LT(std::sqrt(squares), 0.05);
}

// ---- noise ----------------------------------------------------------------------------------------------------------

TEST_F(PathReuse, LessNoiseInADiffuseRoom) {
  RenderPlan settings = asked(16);
  settings.max_depth = 5;
  const Subject shown = room(room_of_hidden_lamp(plain_material()), settings);
  RenderPlan long_one = reusing(settings);
  long_one.last_sample = 4096, long_one.seed = 1000;
  const Picture reference = render(shown, long_one).picture;
  double together = 0.0, alone = 0.0;
  for (settings.seed = 0; settings.seed < 8; ++settings.seed) {
    together += compare_pictures(render(shown, reusing(settings)).picture, reference).mse;
    alone += compare_pictures(render(shown, apart(settings)).picture, reference).mse;
  }
  RecordProperty("ratio", std::to_string(together / alone));
  EXPECT_LT(together, 0.5 * alone);
}

// ---- bits -----------------------------------------------------------------------------------------------------------

TEST_F(PathReuse, BitsDoNotDependOnHowTheWorkIsCut) {
  Material glossy = plain_material();
  glossy.specular = 1.0f;
  const Scene scene = parted_room(glossy);
  for (const auto& [width, height] : {std::pair{43u, 37u}, {7u, 5u}, {1u, 1u}, {3u, 1u}})
    for (const bool has_probes : {false, true}) {
      SCOPED_TRACE(fmt::format("{}x{} whole {}", width, height, has_probes));
      RenderPlan settings = reusing(asked(6));
      settings.width = width, settings.height = height;
      settings = has_probes ? probed(settings) : split(settings);
      const Subject shown = room(scene, settings);
      const RenderResult expected = render(shown, settings);
      EXPECT_EQ(expected.film->has_probes, has_probes);
      EXPECT_TRUE(expected.film->quads);
      expect_same_film_however_cut(shown, settings, *expected.film);
      if (width == 43) expect_same_film_resumed(shown, settings, *expected.film);
    }
}

TEST_F(PathReuse, BitsOfAdaptiveRendersDoNotDependOnHowTheWorkIsCut) {
  for (const bool has_probes : {false, true}) {
    RenderPlan settings = reusing(asked(32));
    settings.width = 43, settings.height = 37;
    settings.adaptive = kAdaptiveOn;
    settings = has_probes ? probed(settings) : split(settings);
    const Subject shown = room(parted_room(plain_material()), settings);
    const RenderResult expected = render(shown, settings);
    settings.wave_slots = 777;
    EXPECT_TRUE(*render(shown, settings).film == *expected.film) << "whole " << has_probes;
  }
}

// Kernels that support both render apart what plain kernels do, and together what those for reuse alone do; those that
// know more than the scene has, what its own do.
TEST_F(PathReuse, BitsDoNotDependOnWhatKernelsSupport) {
  for (const float specular : {0.0f, 1.0f}) {
    SCOPED_TRACE(specular);
    kernels_.reset(); // none of other scenes, which would serve this one
    Material wall = plain_material();
    wall.specular = specular;
    RenderPlan made = asked(4), trying = made;
    made.kernels.reuse = BearsReuse::nowhere;
    const Subject shown = room(parted_room(wall), made);
    const auto alone = render(shown, apart(made)).film, together = render(shown, reusing(made)).film;
    EXPECT_TRUE(*render(shown, apart(trying)).film == *alone);
    EXPECT_TRUE(*render(shown, reusing(trying)).film == *together);
    RenderPlan more = reusing(made), generic = more;
    generic.specialize = false;
    EXPECT_TRUE(*render(shown, generic).film == *together) << "generic kernels";
    more.kernels.added = gpu::kFeatureNormalMaps | gpu::kFeatureSmoothNormals | gpu::kFeatureAlpha |
                         gpu::kFeatureTransmission | gpu::kFeatureTextures | gpu::kFeatureSpecular | gpu::kLobeSheen;
    EXPECT_TRUE(*render(shown, more).film == *together) << "more features";
  }
}

// ---- where it is taken ----------------------------------------------------------------------------------------------

TEST_F(PathReuse, IsForPathsThatScatterTwiceByTheCosine) {
  RenderPlan settings = reusing(asked(2));
  EXPECT_TRUE(reuses_paths(settings));
  EXPECT_FALSE(reuses_paths(apart(settings)));
  RenderPlan automatic = settings;
  automatic.reuse = kReuseAuto;
  EXPECT_FALSE(reuses_paths(automatic)) << "before it is chosen";
  const std::map<std::string, std::function<void(RenderPlan&)>> changes = {
      {"guide", [](RenderPlan& s) { s.guide = true; }},
      {"hemisphere", [](RenderPlan& s) { s.hemisphere = gpu::kHemisphereUniform; }},
      {"one bounce", [](RenderPlan& s) { s.max_depth = 1; }},
      {"moving", [](RenderPlan& s) { s.moving = true; }}};
  for (const auto& [name, change] : changes) {
    SCOPED_TRACE(name);
    RenderPlan other = settings;
    other.kernels.reuse = BearsReuse::nowhere;
    change(other);
    EXPECT_FALSE(reuses_paths(other));
    const Subject shown = room(parted_room(plain_material()), other);
    EXPECT_TRUE(*render(shown, other).film == *render(shown, apart(other)).film);
  }
}

TEST_F(PathReuse, AutoTakesItWhereLightComesByDiffuseSurfaces) {
  const auto choose = [&](const Scene& scene, std::uint32_t spp, std::uint32_t depth = 5) {
    RenderPlan settings = asked(spp);
    settings.width = settings.height = 64;
    settings.max_depth = depth;
    settings.reuse = kReuseAuto;
    settings.kernels.reuse = BearsReuse::nowhere;
    const Subject shown = room(scene, settings, {0.0, 0.1, 1.9});
    if (!kernels_) kernels_ = std::make_unique<KernelCompiler>(device());
    SceneOnDevice on_device;
    PilotRunner pilots(device(), shown.packed, shown.view, *kernels_, on_device);
    return choose_reuse(pilots, settings);
  };
  const Scene diffuse = parted_room(plain_material());
  const ReuseChoice first = choose(diffuse, 4096), again = choose(diffuse, 4096);
  EXPECT_TRUE(first.tried);
  EXPECT_TRUE(first.pays);
  EXPECT_LT(first.cost, 0.9);
  EXPECT_EQ(first.cost, again.cost) << "no clock decides";
  EXPECT_FALSE(choose(diffuse, 4).tried) << "too short for pilots";
  EXPECT_FALSE(choose(diffuse, 4096, 1).tried) << "no second bounce";

  Scene open;
  open.path = "floor";
  open.materials = {plain_material()};
  add_wall(open, {-40, -1, -40}, {0, 0, 80}, {80, 0, 0}, 0);
  open.environment.radiance = glm::vec3(1.0f);
  open.environment.width = 16, open.environment.height = 8;
  for (int i = 0; i < 128; ++i) open.environment.map.emplace_back(i == 20 ? 40.0f : i < 64 ? 0.3f : 0.0f);
  const ReuseChoice floor = choose(open, 4096);
  EXPECT_TRUE(floor.tried);
  EXPECT_FALSE(floor.pays) << floor.cost;
  for (const float roughness : {0.0f, 0.4f}) {
    Material metal = plain_material();
    metal.metallic = 1.0f;
    metal.roughness = roughness;
    const ReuseChoice choice = choose(parted_room(metal), 4096);
    EXPECT_TRUE(choice.tried);
    EXPECT_FALSE(choice.pays) << choice.cost;
  }
}

// ---- the error that is told -----------------------------------------------------------------------------------------

// Without the wall that parts it, so that no half is dark. Of much noise the estimate says too little: of 8 samples
// here 0.91 of the true error with reuse and 0.96 without, perhaps since it weighs a pixel by what is around it, which
// errs alike within a quad.
Scene bright_room() {
  Scene scene = room_of_hidden_lamp(plain_material());
  scene.instances.erase(scene.instances.begin() + 6, scene.instances.begin() + 12);
  return scene;
}

// As in error_test.cpp, by fewer seeds.
TEST_F(PathReuse, TheIntervalHoldsTheTrueError) {
  for (const bool has_probes : {false, true}) {
    SCOPED_TRACE(has_probes ? "error probes" : "split replicates");
    constexpr std::uint32_t kRuns = 40, kReference = 32;
    RenderPlan settings = reusing(asked(has_probes ? 8 : 32));
    settings.width = settings.height = has_probes ? 96 : 40;
    settings = has_probes ? probed(settings) : split(settings);
    const Subject shown = room(bright_room(), settings);
    RenderPlan long_one = settings;
    long_one.last_sample *= kReference, long_one.seed = 1000000;
    const Picture reference = render(shown, long_one).picture;
    const Coverage found = measure_coverage(reference, kRuns, [&](std::uint32_t seed) {
      settings.seed = seed;
      return render(shown, settings);
    });
    // 38 are expected. There are 576 probes here, a quarter of what pictures have that are large enough for probes by
    // themselves: 34 are covered without reuse, of half as many samples.
    EXPECT_GE(found.covered, has_probes ? 31u : 35u);
    EXPECT_NEAR(found.ratio.mean(), 1.0, has_probes ? 0.1 : 0.05) << "its own noise is " << found.ratio.error();
  }
}

} // namespace
} // namespace wavepath::test
