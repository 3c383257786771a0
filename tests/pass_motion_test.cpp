// Passes motion and motion_back: frames warped by them show the same points of surfaces, whatever moves and by whatever
// camera; the background turns with the camera; flags, repeated frames and bad input.
#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/picture/files/picture_io.h"
#include "tests/gltf_builder.h"
#include "tests/run_wavepath.h"
#include "tests/shadow_scene.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

constexpr double kTurn = 0.4, kSide = 0.8; // of the camera within the second: radians about +Y, metres along +X
constexpr int kCells = 2;                  // of a grid, each way

// A grid of kCells^2 squares over [-1,1]^2, whose texture coordinates run from 0 to 1; its mesh has these attributes.
struct Grid {
  std::vector<float> positions, uvs;
  std::vector<std::uint16_t> indices;

  Grid() {
    for (int y = 0; y <= kCells; ++y)
      for (int x = 0; x <= kCells; ++x) {
        const float u = static_cast<float>(x) / kCells, v = static_cast<float>(y) / kCells;
        positions.insert(positions.end(), {2.0f * u - 1.0f, 2.0f * v - 1.0f, 0.0f});
        uvs.insert(uvs.end(), {u, v});
      }
    const auto at = [](int x, int y) { return static_cast<std::uint16_t>(y * (kCells + 1) + x); };
    for (int y = 0; y < kCells; ++y)
      for (int x = 0; x < kCells; ++x)
        for (const std::uint16_t index :
             {at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)})
          indices.push_back(index);
  }
};

// The triangle of a grid with these texture coordinates.
int triangle_of(double u, double v) {
  const double x = u * kCells, y = v * kCells;
  const bool upper = x - std::floor(x) + y - std::floor(y) > 1.0;
  return 2 * (static_cast<int>(y) * kCells + static_cast<int>(x)) + upper;
}

std::vector<float> turned_about(const glm::dvec3& axis, double angle) {
  const glm::dvec3 sine = std::sin(0.5 * angle) * axis;
  return {0.0f,
          0.0f,
          0.0f,
          1.0f,
          static_cast<float>(sine.x),
          static_cast<float>(sine.y),
          static_cast<float>(sine.z),
          static_cast<float>(std::cos(0.5 * angle))};
}

// Within a second a skinned strip bends, a morphed one swells, two that share a mesh go their own ways, one of them
// mirrored; a wall behind stands still, and the camera turns and goes aside.
std::string moving_scene(const TempFolder& folder) {
  GltfBuilder b;
  const Grid grid;
  const int positions = b.floats("VEC3", grid.positions), uvs = b.floats("VEC2", grid.uvs);
  const int indices = b.accessor("SCALAR", kUshort, grid.indices);
  b.add("images", {{"uri",
                    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8z8BQDwAEhQGAhKmM"
                    "IQAAAABJRU5ErkJggg=="}});
  b.add("textures", {{"source", 0}});
  b.add("materials", {{"doubleSided", true}, {"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  const Json attributes = {{"POSITION", positions}, {"TEXCOORD_0", uvs}},
             more = {{"indices", indices}, {"material", 0}};
  const auto node = [&](int index) -> Json& { return b.root["nodes"][static_cast<unsigned>(index)]; };

  std::vector<std::uint8_t> joints, weights;
  for (std::size_t i = 0; i < grid.positions.size(); i += 3) {
    const float up = 0.5f * (grid.positions[i + 1] + 1.0f);
    joints.insert(joints.end(), {0, 1, 0, 0});
    const auto weight = static_cast<std::uint8_t>(std::lround(255.0f * up));
    weights.insert(weights.end(), {static_cast<std::uint8_t>(255 - weight), weight, 0, 0});
  }
  Json skinned = attributes;
  skinned["JOINTS_0"] = b.accessor("VEC4", kUbyte, joints);
  skinned["WEIGHTS_0"] = b.accessor("VEC4", kUbyte, weights, true);
  const int bent = b.mesh_node(skinned, more);
  const int joint = b.add("nodes", {{"translation", {-1.2, 0, 0}}, {"scale", {0.5, 1, 1}}});
  const int tip = b.add("nodes", Json::object());
  node(joint)["children"] = {tip};
  node(bent)["skin"] = b.add("skins", {{"joints", {joint, tip}}});

  std::vector<float> swelling;
  for (std::size_t i = 0; i < grid.positions.size(); i += 3) {
    const float x = grid.positions[i], y = grid.positions[i + 1];
    swelling.insert(swelling.end(), {0.3f * y, 0.2f * x * y, 0.8f * (1.0f - x * x)});
  }
  Json morphed = more;
  morphed["targets"] = {{{"POSITION", b.floats("VEC3", swelling)}}};
  const int swollen = b.mesh_node(attributes, morphed);
  node(swollen)["translation"] = {0.1, 0.4, 0};
  node(swollen)["scale"] = {0.5, 0.5, 0.5};

  const int one = b.mesh_node(attributes, more), other = b.add("nodes", {{"mesh", node(one)["mesh"]}});
  node(one)["translation"] = {1.2, -0.5, 0.3}, node(one)["scale"] = {0.4, 0.4, 0.4};
  node(other)["translation"] = {1.2, 0.6, 0}, node(other)["scale"] = {-0.4, 0.4, 0.4};
  const int wall = b.mesh_node(attributes, more);
  node(wall)["translation"] = {0, 0, -1}, node(wall)["scale"] = {2, 1.2, 1};
  b.add("cameras", {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}});
  const int eye = b.add("nodes", {{"camera", 0}, {"translation", {0.1, 0.1, 2.5}}});

  const int times = b.floats("SCALAR", {0.0f, 1.0f});
  Json animation = {{"name", "all"}};
  const auto move = [&](int target, const char* path, const std::string& type, const std::vector<float>& values) {
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", target}, {"path", path}}}});
    animation["samplers"].push_back({{"input", times}, {"output", b.floats(type, values)}});
  };
  move(tip, "rotation", "VEC4", turned_about({0, 0, 1}, 0.9));
  move(joint, "translation", "VEC3", {-1.2f, 0, 0, -1.0f, 0.2f, 0.4f});
  move(swollen, "weights", "SCALAR", {0, 1});
  move(one, "rotation", "VEC4", turned_about({0.6, 0.8, 0}, 1.0));
  move(other, "translation", "VEC3", {1.2f, 0.6f, 0, 0.7f, 0.9f, 0.2f});
  move(other, "scale", "VEC3", {-0.4f, 0.4f, 0.4f, -0.6f, 0.4f, 0.4f});
  move(eye, "translation", "VEC3", {0.1f, 0.1f, 2.5f, static_cast<float>(0.1 + kSide), 0.1f, 2.5f});
  move(eye, "rotation", "VEC4", turned_about({0, 1, 0}, kTurn));
  b.add("animations", animation);
  b.root["scenes"] = {{{"nodes", {bent, joint, swollen, one, other, wall, eye}}}};
  b.root["scene"] = 0;
  return folder.write("moving.glb", b.glb()).string();
}

class PassMotion : public ProgramTest {
protected:
  PassMotion() : scene_(moving_scene(folder_)) {}

  Outcome run(const std::string& line) const {
    return run_program({"/bin/sh", "-c", "exec " WAVEPATH_BINARY " " + line}, {.folder = folder_.path().string()});
  }
  // A frame with what its pixels show.
  std::string render(const std::string& more) const {
    return fmt::format("render {} --spp 1 --max-depth 0 --env white -q --aov motion,motion_back,uv,node,depth0 {}",
                       scene_, more);
  }
  Picture read(const std::string& name) const { return read_picture((folder_.path() / name).string()); }
  void expect_refused(const std::string& line, const std::string& words) const {
    const Outcome outcome = run(line);
    EXPECT_EQ(outcome.exit_code, 2) << line << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(std::ranges::count(outcome.err, '\n'), 1) << outcome.err;
  }

  TempFolder folder_;
  std::string scene_;
};

// Channels of two values, between the centres of pixels.
struct Field {
  const Picture& picture;
  const std::vector<float>&x, &y;

  Field(const Picture& of, const std::string& name)
      : picture(of), x(channel(of, name + ".X")), y(channel(of, name + ".Y")) {}
  glm::dvec2 at(std::size_t i) const { return {x[i], y[i]}; }
  // `place` in pixels from the middle of the first one; not on the last row or column.
  glm::dvec2 at(const glm::dvec2& place) const {
    const glm::dvec2 low = glm::floor(place), f = place - low;
    const std::size_t i = static_cast<std::size_t>(low.y) * picture.width + static_cast<std::size_t>(low.x);
    return glm::mix(glm::mix(at(i), at(i + 1), f.x), glm::mix(at(i + picture.width), at(i + picture.width + 1), f.x),
                    f.y);
  }
};

struct Warped {
  int compared = 0;
  double worst = 0.0, worst_return = 0.0; // pixels
  std::vector<int> of_node = std::vector<int>(16);
};

// Where the pixels of one frame are in the next: the point of the surface with the same texture coordinates, which is
// looked for by the slope of these. Triangles of a grid with those coordinates are the same.
Warped warp(const Picture& a, const Picture& b, const std::string& there, const std::string& back) {
  Warped found;
  const Field motion(a, there), uv_a(a, "uv"), uv_b(b, "uv"), motion_back(b, back);
  const auto &node_a = channel(a, "id.node"), &node_b = channel(b, "id.node");
  for (std::size_t i = 0; i < node_a.size(); ++i) {
    const glm::dvec2 pixel(static_cast<double>(i % a.width), static_cast<double>(i / a.width)),
        place = pixel + motion.at(i);
    if (node_a[i] < 0.0f || !(place.x >= 1.0 && place.y >= 1.0 && place.x < a.width - 2 && place.y < a.height - 2))
      continue;
    const int triangle = triangle_of(uv_a.at(i).x, uv_a.at(i).y);
    bool same = true;
    const std::size_t corner =
        (static_cast<std::size_t>(place.y) - 1) * a.width + static_cast<std::size_t>(place.x) - 1;
    for (std::size_t dy = 0; dy < 4; ++dy)
      for (std::size_t dx = 0; dx < 4; ++dx) {
        const std::size_t n = corner + dy * a.width + dx;
        same = same && node_b[n] == node_a[i] && triangle_of(uv_b.at(n).x, uv_b.at(n).y) == triangle;
      }
    if (!same) continue;
    const glm::dvec2 across = uv_b.at(place + glm::dvec2(0.5, 0)) - uv_b.at(place - glm::dvec2(0.5, 0)),
                     down = uv_b.at(place + glm::dvec2(0, 0.5)) - uv_b.at(place - glm::dvec2(0, 0.5));
    const glm::dmat2 slope(across, down);
    if (std::abs(glm::determinant(slope)) < 1e-9) continue;
    const glm::dvec2 miss = glm::inverse(slope) * (uv_a.at(i) - uv_b.at(place));
    ++found.compared;
    ++found.of_node[static_cast<std::size_t>(node_a[i])];
    found.worst = std::max(found.worst, glm::length(miss));
    found.worst_return = std::max(found.worst_return, glm::length(motion.at(i) + motion_back.at(place)));
  }
  return found;
}

struct CameraCase {
  const char *name, *flags;
};
void PrintTo(const CameraCase& one, std::ostream* out) { *out << one.name; }

class PassMotionOf : public PassMotion, public testing::WithParamInterface<CameraCase> {};
INSTANTIATE_TEST_SUITE_P(
    Cameras, PassMotionOf,
    testing::Values(CameraCase{"perspective", "--size 192x128"},
                    CameraCase{"shift", "--size 192x128 --shift 0.1,-0.05"},
                    CameraCase{"intrinsics", "--size 192x128 --intrinsics 120,110,90,70"},
                    CameraCase{"orthographic", "--size 192x128 --projection orthographic --ymag 1.4"},
                    CameraCase{"fisheye", "--size 192x160 --projection fisheye --fov 120"},
                    CameraCase{"sphere", "--size 512x256 --projection equirectangular"},
                    CameraCase{"stereo", "--size 320x128 --stereo 0.2 --yfov 60"},
                    CameraCase{"sphere_stereo", "--size 512x512 --projection equirectangular --stereo 0.2"}),
    [](const auto& of) { return of.param.name; });

TEST_P(PassMotionOf, WarpsAFrameOntoTheNextOne) {
  const Outcome film = run(render(fmt::format("--animation all --frames 4:6 --fps 10 -o f#.exr {}", GetParam().flags)));
  ASSERT_EQ(film.exit_code, 0) << film.err;
  const Picture a = read("f4.exr"), b = read("f5.exr");
  for (const Warped& warped : {warp(a, b, "motion", "motionBack"), warp(b, a, "motionBack", "motion")}) {
    EXPECT_LT(warped.worst, 0.05);
    EXPECT_LT(warped.worst_return, 0.05);
    EXPECT_GT(warped.compared, 500);
    for (const std::size_t node : {0, 3, 4, 5, 6}) EXPECT_GT(warped.of_node[node], 10) << node;
  }
}

// A camera by the formulas of a textbook, in the picture's pixels.
struct Pinhole {
  glm::dvec3 eye, target;
  double scale; // pixels at a distance of 1
  glm::dvec2 middle;

  glm::dvec2 project(const glm::dvec3& point) const {
    const glm::dvec3 ahead = glm::normalize(target - eye), right = glm::normalize(glm::cross(ahead, {0, 1, 0})),
                     up = glm::cross(right, ahead), d = point - eye;
    return middle + scale / glm::dot(d, ahead) * glm::dvec2(glm::dot(d, right), -glm::dot(d, up));
  }
};

// Where both cameras show `position0`, which the first of them shows at the pixel's centre.
TEST_F(PassMotion, IsTheDifferenceOfTwoProjections) {
  constexpr int kWidth = 96, kHeight = 64;
  const Outcome outcome = run(fmt::format(
      "render {} --size {}x{} --spp 1 --max-depth 0 -q --aov motion,motion_back,position0,node -o m.exr --yfov 50 "
      "--eye 0,0.5,2.5 --look-at 0,0,0 --camera-to 0.4,0.2,2.2,0.1,0,-0.2 --camera-from -0.3,0.9,3.0,0,0.1,0.2",
      scene_, kWidth, kHeight));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  const Picture picture = read("m.exr");
  const Field there(picture, "motion"), back(picture, "motionBack");
  const double scale = 0.5 * kHeight / std::tan(glm::radians(25.0));
  const glm::dvec2 middle(0.5 * kWidth, 0.5 * kHeight);
  const Pinhole here{{0, 0.5, 2.5}, {0, 0, 0}, scale, middle}, next{{0.4, 0.2, 2.2}, {0.1, 0, -0.2}, scale, middle},
      previous{{-0.3, 0.9, 3.0}, {0, 0.1, 0.2}, scale, middle};
  const auto &x = channel(picture, "P0.X"), &y = channel(picture, "P0.Y"), &z = channel(picture, "P0.Z");
  int seen = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    if (channel(picture, "id.node")[i] < 0.0f) continue;
    ++seen;
    const glm::dvec3 point(x[i], y[i], z[i]);
    const glm::dvec2 centre(static_cast<double>(i % kWidth) + 0.5, static_cast<double>(i / kWidth) + 0.5);
    ASSERT_LT(glm::length(here.project(point) - centre), 1e-3) << i;
    ASSERT_LT(glm::length(next.project(point) - here.project(point) - there.at(i)), 1e-3) << i;
    ASSERT_LT(glm::length(previous.project(point) - here.project(point) - back.at(i)), 1e-3) << i;
  }
  EXPECT_GT(seen, 2000);
}

// Rays of their own: no integrator and no part of the samples changes a bit.
TEST_F(PassMotion, AnyIntegratorAndPartsHaveTheSame) {
  const std::string line = fmt::format(
      "render {} --size 48x32 --spp 4 --max-depth 1 --env white -q --animation all --at "
      "0.3 --motion-to 0.4 --motion-from 0.2 --aov motion,motion_back ",
      scene_);
  ASSERT_EQ(run(line + "--integrator path -o path.exr").exit_code, 0);
  for (const char* integrator : {"bidirectional", "hybrid"})
    ASSERT_EQ(run(fmt::format("{} --integrator {} -o {}.exr", line, integrator, integrator)).exit_code, 0);
  for (const char* samples : {"0:1", "1:4"})
    ASSERT_EQ(run(fmt::format("{} --integrator path --samples {} -o part{}.exr", line, samples, samples[0])).exit_code,
              0);
  const Outcome merged = run("merge part0.exr part1.exr -o merged.exr");
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  const Picture path = read("path.exr");
  for (const char* other : {"bidirectional.exr", "hybrid.exr", "merged.exr"}) {
    const Picture found = read(other);
    for (const char* name : {"motion.X", "motion.Y", "motionBack.X", "motionBack.Y"}) {
      const std::vector<float>&expected = channel(path, name), &values = channel(found, name);
      EXPECT_GT(*std::ranges::max_element(expected), 0.5f);
      ASSERT_EQ(values.size(), expected.size());
      for (std::size_t i = 0; i < values.size(); ++i)
        ASSERT_EQ(std::bit_cast<std::uint32_t>(values[i]), std::bit_cast<std::uint32_t>(expected[i]))
            << other << " " << name << " " << i;
    }
  }
}

// By the turn between two frames, 0.04 radians to the left; 0.08 metres aside count for nothing at infinity.
TEST_F(PassMotion, TheBackgroundTurnsWithTheCamera) {
  ASSERT_EQ(run(render("--animation all --frames 4:5 --fps 10 --size 96x64 -o f.exr")).exit_code, 0);
  const Picture picture = read("f.exr");
  const Field there(picture, "motion"), back(picture, "motionBack");
  const double scale = std::tan(0.5) / 32.0, turn = 0.1 * kTurn;
  int seen = 0;
  for (std::size_t i = 0; i < there.x.size(); ++i) {
    if (channel(picture, "id.node")[i] >= 0.0f) continue;
    ++seen;
    const double x = static_cast<double>(i % 96) + 0.5 - 48.0, y = 32.0 - static_cast<double>(i / 96) - 0.5;
    for (const double sign : {1.0, -1.0}) {
      const double cosine = std::cos(turn), sine = sign * std::sin(turn);
      const double to_right = cosine * x * scale + sine, ahead = cosine - sine * x * scale;
      const glm::dvec2 expected(to_right / ahead / scale - x, -(y / ahead - y));
      const glm::dvec2 found = sign > 0.0 ? there.at(i) : back.at(i);
      ASSERT_LT(glm::length(found - expected), 1e-3) << i;
    }
  }
  EXPECT_GT(seen, 500);
}

// Of frames alone, by the command that their stats tell.
TEST_F(PassMotion, AFrameIsRepeatedWithItsMotion) {
  const auto is_repeated = [&](const std::string& film, const std::string& flag) {
    ASSERT_EQ(run(render(film + " --size 48x32 -o f.exr --stats f.json --overwrite")).exit_code, 0) << film;
    const std::string command =
        Json::parse(std::ifstream(folder_.path() / "f.json"))["repeat"].get<std::string>().substr(9);
    EXPECT_NE(command.find(flag), std::string::npos) << command;
    EXPECT_GT(Json::parse(std::ifstream(folder_.path() / "f.json"))["seconds"]["passes"], 0.0);
    ASSERT_EQ(run(command + " -q -o again.exr").exit_code, 0) << command;
    const Picture film_frame = read("f.exr"), again = read("again.exr");
    double moved = 0.0;
    for (const char* name : {"motion.X", "motion.Y", "motionBack.X", "motionBack.Y"}) {
      const std::vector<float>&values = channel(film_frame, name), &repeated = channel(again, name);
      for (std::size_t i = 0; i < values.size(); ++i) {
        ASSERT_EQ(std::bit_cast<std::uint32_t>(values[i]), std::bit_cast<std::uint32_t>(repeated[i]))
            << name << " " << command;
        if (!std::isnan(values[i])) moved = std::max(moved, static_cast<double>(std::abs(values[i])));
      }
    }
    EXPECT_GT(moved, 1.0) << command;
  };
  is_repeated("--animation all --fps 10 --frames 2:3", "--motion-from");
  is_repeated("--animation all --fps 10 --shutter 0.01,0.05 --frames 0:1", "--motion-to");
  is_repeated("--turntable 90 --frames 2:3", "--camera-to");
  is_repeated("--animation all --fps 10 --turntable 90 --frames 0:1", "--camera-from");
}

// What stands still for a camera that does has exactly none.
TEST_F(PassMotion, IsToldToOtherCamerasAndMoments) {
  const auto worst = [&](const std::string& more) {
    const Outcome outcome =
        run(fmt::format("render {} --size 48x32 --spp 1 --max-depth 0 -q --aov motion,node -o m.exr {}", scene_, more));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    const Picture picture = read("m.exr");
    const Field motion(picture, "motion");
    double of_wall = 0.0;
    for (std::size_t i = 0; i < motion.x.size(); ++i)
      if (channel(picture, "id.node")[i] == 6.0f) of_wall = std::max(of_wall, glm::length(motion.at(i)));
    return of_wall;
  };
  EXPECT_EQ(worst("--camera-to 0"), 0.0);
  EXPECT_GT(worst("--camera-to 0,0.5,2.5,0,0,0"), 1.0);
  EXPECT_EQ(worst("--animation all --at 0.3 --motion-to 0.3"), 0.0);
  EXPECT_GT(worst("--animation all --at 0.3 --motion-to 0.4"), 0.5);
  EXPECT_EQ(worst("--animation all --at 0.3 --eye 0,0,3 --look-at 0,0,0 --motion-to 0.4"), 0.0);
}

// Where the other camera has the wall behind it.
TEST_F(PassMotion, HasNoPlaceBehindACamera) {
  ASSERT_EQ(run(fmt::format("render {} --size 48x32 --spp 1 --max-depth 0 -q --aov motion,node -o m.exr --camera-to "
                            "0,0,-3,0,0,-4",
                            scene_))
                .exit_code,
            0);
  const Picture picture = read("m.exr");
  for (std::size_t i = 0; i < channel(picture, "motion.X").size(); ++i)
    ASSERT_EQ(std::isnan(channel(picture, "motion.X")[i]), channel(picture, "id.node")[i] >= 0.0f);
}

TEST_F(PassMotion, RefusesWhatHasNoOtherPicture) {
  const std::string line = fmt::format("render {} --size 8x8 --spp 1 -q -o no.exr ", scene_);
  expect_refused(line + "--aov motion", "has no other picture");
  expect_refused(line + "--aov motion_back", "has no other picture");
  expect_refused(line + "--camera-to 0", "--camera-to: means nothing without --aov motion");
  expect_refused(line + "--aov motion --motion-to 1", "means nothing without an animation");
  expect_refused(line + "--aov motion --camera-to 1,2,x,4,5,6", "is not six numbers");
  expect_refused(line + "--aov motion --camera-to 1,2,3,4,5,6,0,y,0", "is not nine numbers");
  expect_refused(line + "--aov motion --camera-to 1,2,3,1,2,3", "--camera-to");
  expect_refused(line + "--aov motion --turntable 90 --frames 0:1 --camera-to 0", "is told by the frames");
  EXPECT_FALSE(std::filesystem::exists(folder_.path() / "no.exr"));
}

} // namespace
} // namespace wavepath::test
