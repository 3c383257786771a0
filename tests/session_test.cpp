// A scene that is edited to be like another file gives that file's bits, however it got there; memory stays constant.
#include <bit>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/picture/files/picture_io.h"
#include "host/plan/plan.h"
#include "host/render/progressive/progressive.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/session/resolve.h"
#include "host/session/session.h"
#include "tests/gltf_checks.h"
#include "tests/moving_lamps.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

using Edit = std::function<void(Session&)>;

// What the file holds: a floor, two boxes' lids of one mesh, and a lid of its own that may shine.
struct Room {
  std::vector<double> own_color = {0.8, 0.4, 0.2, 1.0};
  double own_roughness = 0.5, floor_roughness = 1.0, alpha_cutoff = -1.0;
  std::vector<double> own_emission = {0, 0, 0};
  double floor_scale = 3.0;
  glm::dmat4 own = place(0.0), twin = place(1.2);
  bool shows_own = true, shows_twin = true, has_texture = false, has_more = false;

  static glm::dmat4 place(double x) {
    glm::dmat4 matrix(1.0);
    matrix[3] = {x, 0.5, 0.25, 1.0};
    return matrix;
  }
};

constexpr std::size_t kOwn = 1, kTwin = 2, kOtherTwin = 3; // nodes; the floor is 0
constexpr std::size_t kOwnMaterial = 1;

std::vector<double> list(const glm::dmat4& m) {
  std::vector<double> values;
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) values.push_back(m[column][row]);
  return values;
}

std::string write_room(const TempFolder& folder, const std::string& name, const Room& room) {
  GltfBuilder b;
  const int positions = b.floats("VEC3", {-1, 0, 1, 1, 0, 1, 1, 0, -1, -1, 0, -1});
  const int small = b.floats("VEC3", {-.4f, 0, .4f, .4f, 0, .4f, .4f, 0.2f, -.4f, -.4f, 0.2f, -.4f});
  const int uvs = b.floats("VEC2", {0, 0, 1, 0, 1, 1, 0, 1});
  const int indices = b.accessor("SCALAR", kUshort, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  nlohmann::json own = {
      {"name", "own"},
      {"doubleSided", true},
      {"emissiveFactor", room.own_emission},
      {"pbrMetallicRoughness",
       {{"baseColorFactor", room.own_color}, {"roughnessFactor", room.own_roughness}, {"metallicFactor", 0.0}}}};
  if (room.alpha_cutoff >= 0.0) own["alphaMode"] = "MASK", own["alphaCutoff"] = room.alpha_cutoff;
  b.add("materials", {{"name", "floor"},
                      {"doubleSided", true},
                      {"pbrMetallicRoughness", {{"roughnessFactor", room.floor_roughness}, {"metallicFactor", 0.0}}}});
  b.add("materials", own);
  const int normals = b.floats("VEC3", {0, 1, 0, 0.6f, 0.8f, 0, 0, 0.8f, 0.6f, 0, 0.6f, 0.8f});
  const auto mesh = [&](int points, int material) {
    nlohmann::json attributes = {{"POSITION", points}, {"TEXCOORD_0", uvs}};
    if (points == small) attributes["NORMAL"] = normals;
    return b.add("meshes",
                 {{"primitives", {{{"attributes", attributes}, {"indices", indices}, {"material", material}}}}});
  };
  const int floor = mesh(positions, 0), lid = mesh(small, 1), shared = mesh(small, 0);
  b.add("nodes", {{"name", "floor"}, {"mesh", floor}, {"scale", {room.floor_scale, 1, room.floor_scale}}});
  b.add("nodes", {{"name", "own"}, {"mesh", lid}, {"matrix", list(room.own)}});
  b.add("nodes", {{"name", "twin"}, {"mesh", shared}, {"matrix", list(room.twin)}});
  b.add("nodes", {{"name", "other twin"}, {"mesh", shared}, {"matrix", list(Room::place(-1.2))}});
  const auto hide = [&](std::size_t node) {
    b.root["nodes"][node]["extensions"]["KHR_node_visibility"]["visible"] = false;
    b.root["extensionsUsed"] = {"KHR_node_visibility"};
  };
  if (!room.shows_own) hide(kOwn);
  if (!room.shows_twin) hide(kTwin);
  std::vector<int> nodes = {0, 1, 2, 3};
  if (room.has_more) nodes.push_back(b.add("nodes", {{"mesh", mesh(small, 1)}, {"matrix", list(Room::place(2.0))}}));
  b.root["scenes"] = {{{"nodes", nodes}}};
  b.root["scene"] = 0;
  return folder.write(name, b.glb()).string();
}

class SessionTest : public VulkanTest {
protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (!test_device().device) return;
    shared_.device = std::shared_ptr<Device>(&device(), [](Device*) {});
    shared_.kernels = std::make_shared<KernelCompiler>(device());
  }

  SessionRequest request(const Room& room, SessionUse use = SessionUse::edits) {
    SessionRequest wanted;
    wanted.scene.path = write_room(folder_, fmt::format("room{}.glb", ++files_), room);
    wanted.scene.environment = "0.5,0.6,0.7";
    wanted.scene.catcher = catcher_;
    wanted.scene.view.eye = glm::dvec3(0.5, 2.0, 3.0);
    wanted.scene.view.look_at = glm::dvec3(0.0, 0.3, 0.0);
    wanted.render.origin = glm::dvec3(0.0);
    wanted.render.settings.width = 40;
    wanted.render.settings.height = 30;
    wanted.render.settings.sample_total = 2;
    wanted.render.settings.max_depth = 3;
    wanted.render.given = {"integrator"};
    wanted.device = shared_;
    wanted.use = use;
    resolve_settings(wanted.scene, wanted.render);
    return wanted;
  }

  static std::vector<float> bits(Session& session, const RenderRequest& render) {
    return picture_bits(session.render(render).result.picture);
  }
  static std::vector<float> picture_bits(const Picture& picture) {
    std::vector<float> values;
    for (const char* name : {"R", "G", "B", "A"})
      for (const float value : find_channel(picture, name)->values) values.push_back(value);
    return values;
  }
  // Of a render that is stepped, at rest.
  static std::vector<float> bits(Progressive& render) {
    render.rest();
    while (!render.is_done())
      if (!render.step()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return picture_bits(render.picture());
  }
  std::vector<float> alone(const Room& room) {
    const SessionRequest wanted = request(room, SessionUse::one_picture);
    Session session(wanted);
    return bits(session, wanted.render);
  }

  // `from`, edited, is `to`; edited back, it is `from` again.
  void expect_like(const Room& from, const Room& to, const Edit& edit, const Edit& back) {
    const SessionRequest wanted = request(from);
    const std::vector<float> first = alone(from), second = alone(to);
    EXPECT_NE(first, second) << "the edit shows";
    Session session(wanted);
    EXPECT_EQ(bits(session, wanted.render), first);
    edit(session);
    EXPECT_EQ(bits(session, wanted.render), second) << "there";
    EXPECT_TRUE(session.update().redone.empty());
    back(session);
    EXPECT_EQ(bits(session, wanted.render), first) << "and back";
    edit(session), back(session), edit(session); // without pictures between
    EXPECT_EQ(bits(session, wanted.render), second) << "there again";
    Session at_once(wanted);
    edit(at_once);
    EXPECT_EQ(bits(at_once, wanted.render), second) << "before the first picture";
  }

  TempFolder folder_;
  SessionDevice shared_;
  std::string catcher_; // of the requests
  int files_ = 0;
};

Edit with_material(std::size_t index, const std::function<void(Material&)>& change) {
  return [=](Session& session) {
    Material material = session.scene().materials[index];
    change(material);
    session.set_material(index, material);
  };
}

TEST_F(SessionTest, AFactorThatNoTriangleAsksFor) {
  Room other;
  other.own_color = {0.1, 0.9, 0.3, 1.0};
  other.own_roughness = 0.1;
  expect_like({}, other,
              with_material(kOwnMaterial,
                            [](Material& m) {
                              m.base_color = {0.1f, 0.9f, 0.3f, 1.0f};
                              m.roughness = 0.1f;
                            }),
              with_material(kOwnMaterial, [](Material& m) {
                m.base_color = {0.8f, 0.4f, 0.2f, 1.0f};
                m.roughness = 0.5f;
              }));
}

TEST_F(SessionTest, AMaterialThatBeginsToShine) {
  Room other;
  other.own_emission = {1.0, 0.5, 0.25};
  expect_like({}, other,
              with_material(kOwnMaterial,
                            [](Material& m) {
                              m.emission = {1.0f, 0.5f, 0.25f};
                            }),
              with_material(kOwnMaterial, [](Material& m) { m.emission = glm::vec3(0.0f); }));
  Room brighter = other;
  brighter.own_emission = {0.25, 1.0, 1.0};
  expect_like(other, brighter,
              with_material(kOwnMaterial,
                            [](Material& m) {
                              m.emission = {0.25f, 1.0f, 1.0f};
                            }),
              with_material(kOwnMaterial, [](Material& m) {
                m.emission = {1.0f, 0.5f, 0.25f};
              }));
}

TEST_F(SessionTest, AMaterialThatRaysBeginToPass) {
  Room other;
  other.own_color = {0.8, 0.4, 0.2, 0.3};
  other.alpha_cutoff = 0.5;
  expect_like({}, other,
              with_material(kOwnMaterial,
                            [](Material& m) {
                              m.base_color.a = 0.3f;
                              m.alpha_mode = AlphaMode::mask;
                              m.alpha_cutoff = 0.5f;
                            }),
              with_material(kOwnMaterial, [](Material& m) {
                m.base_color.a = 1.0f;
                m.alpha_mode = AlphaMode::opaque;
              }));
}

TEST_F(SessionTest, AMatrixOfAMeshThatIsShownOnce) {
  Room other;
  other.own = Room::place(-0.3);
  other.own[1] = {0.3, 0.8, 0.1, 0.0};
  expect_like(
      {}, other, [&](Session& session) { session.set_matrix(kOwn, other.own); },
      [](Session& session) { session.reset_matrix(kOwn); });
}

TEST_F(SessionTest, AMatrixOfAnInstance) {
  Room other;
  other.twin = Room::place(0.7);
  expect_like(
      {}, other, [&](Session& session) { session.set_matrix(kTwin, other.twin); },
      [](Session& session) { session.set_matrix(kTwin, Room{}.twin); });
}

// Of a scene with instances and of one without.
TEST_F(SessionTest, AMatrixTakesOverWhatDoesNotMove) {
  for (const bool shows_twin : {true, false}) {
    Room room;
    room.shows_twin = shows_twin;
    const SessionRequest wanted = request(room);
    Session session(wanted);
    bits(session, wanted.render);
    for (int step = 0; step < 4; ++step) {
      room.own = Room::place(0.1 * (step + 1));
      room.own[1] = {0.1 * step, 0.8, 0.1, 0.0};
      session.set_matrix(kOwn, room.own);
      const SessionUpdate update = session.update();
      EXPECT_FALSE(update.kept_geometry);
      EXPECT_TRUE(update.kept_shapes);
      EXPECT_EQ(update.built_triangles, 2u); // of four or six
      EXPECT_EQ(bits(session, wanted.render), alone(room)) << step;
    }
    session.set_visible(kOwn, false);
    EXPECT_FALSE(session.update().kept_shapes);
    room.shows_own = false;
    EXPECT_EQ(bits(session, wanted.render), alone(room));
  }
}

TEST_F(SessionTest, VisibilityOfNodes) {
  Room other;
  other.shows_own = false;
  const auto show = [](std::size_t node, bool shown) {
    return [=](Session& session) { session.set_visible(node, shown); };
  };
  expect_like({}, other, show(kOwn, false), show(kOwn, true));
  expect_like(other, {}, show(kOwn, true), show(kOwn, false));
  Room fewer;
  fewer.shows_twin = false;
  expect_like({}, fewer, show(kTwin, false), show(kTwin, true));
}

TEST_F(SessionTest, AMeshThatIsAdded) {
  Room other;
  other.has_more = true;
  std::size_t node = 0;
  expect_like(
      {}, other,
      [&](Session& session) {
        AddedMesh added;
        added.name = "more";
        added.mesh.positions = {{-.4f, 0, .4f}, {.4f, 0, .4f}, {.4f, 0.2f, -.4f}, {-.4f, 0.2f, -.4f}};
        added.mesh.normals = {{0, 1, 0}, {0.6f, 0.8f, 0}, {0, 0.8f, 0.6f}, {0, 0.6f, 0.8f}};
        added.mesh.indices = {0, 1, 2, 0, 2, 3};
        added.mesh.primitives = {{0, 6, kOwnMaterial, true}};
        added.world_from_object = Room::place(1.0);
        node = session.add_mesh(added);
        session.set_matrix(node, Room::place(2.0));
      },
      [&](Session& session) { session.remove_mesh(node); });
}

TEST_F(SessionTest, AnEnvironment) {
  const SessionRequest wanted = request({});
  SessionRequest other = wanted;
  other.scene.environment = "sky";
  other.scene.environment_degrees = 30.0;
  Session sky(other), session(wanted);
  const std::vector<float> first = bits(session, wanted.render), second = bits(sky, wanted.render);
  EXPECT_NE(first, second);
  session.set_environment({"sky", 1.0, 30.0});
  EXPECT_EQ(bits(session, wanted.render), second);
  session.set_environment({"0.5,0.6,0.7"});
  EXPECT_EQ(bits(session, wanted.render), first);
  Environment map;
  map.radiance = glm::vec3(1.0f);
  map.width = 4, map.height = 2;
  map.map.assign(8, glm::vec3(0.5f));
  session.set_environment(map);
  EXPECT_NE(bits(session, wanted.render), first);
  sky.set_environment({"0.5,0.6,0.7"});
  EXPECT_EQ(bits(sky, wanted.render), first);
}

TEST_F(SessionTest, CameraSizeSamplesAndSeedRedoNothing) {
  const SessionRequest wanted = request({});
  SessionRequest other = wanted;
  other.scene.view.eye = glm::dvec3(-2.0, 1.5, 2.0);
  other.render.settings.width = 24;
  other.render.settings.last_sample = 3;
  other.render.settings.seed = 5;
  Session there(other), session(wanted);
  const std::vector<float> first = bits(session, wanted.render);
  session.set_view(other.scene.view);
  EXPECT_TRUE(session.update(other.render).redone.empty());
  EXPECT_EQ(bits(session, other.render), bits(there, other.render));
  session.set_view(wanted.scene.view);
  EXPECT_EQ(bits(session, wanted.render), first);
}

// Names of channels and the bits of their values.
std::vector<std::pair<std::string, std::vector<std::uint32_t>>> all_bits(const Picture& picture) {
  std::vector<std::pair<std::string, std::vector<std::uint32_t>>> channels;
  for (const Channel& channel : picture.channels) {
    std::vector<std::uint32_t>& words = channels.emplace_back().second;
    channels.back().first = channel.name;
    for (const float value : channel.values) words.push_back(std::bit_cast<std::uint32_t>(value));
  }
  return channels;
}

// Kernels, buffers of the film and what they are bound to come and go with these settings.
TEST_F(SessionTest, SettingsOfARenderLeaveNoTraceInTheNext) {
  Room shining;
  shining.own_emission = {1.0, 0.5, 0.25};
  const SessionRequest wanted = request(shining);
  const std::function<void(RenderPlan&)> changes[] = {
      [](RenderPlan&) {},
      [](RenderPlan& plan) {
        plan.light_groups = {"own", "environment"};
      },
      [](RenderPlan& plan) { plan.transparent = true; },
      [](RenderPlan& plan) {
        plan.crop = Crop{3, 5, 17, 11};
      },
      [](RenderPlan& plan) {
        plan.aovs = {"albedo", "normal"};
      },
      [](RenderPlan& plan) { plan.clamp = 0.4; },
      [](RenderPlan& plan) {
        plan.light_groups = {"each"}, plan.transparent = true, plan.crop = Crop{0, 0, 9, 30};
      },
      [](RenderPlan& plan) { plan.width = 52; }};
  std::vector<RenderRequest> renders;
  std::vector<std::vector<std::pair<std::string, std::vector<std::uint32_t>>>> alone;
  for (const auto& change : changes) {
    SessionRequest one = wanted;
    change(one.render.settings);
    resolve_settings(one.scene, one.render);
    Session session(one);
    renders.push_back(one.render);
    alone.push_back(all_bits(session.render(one.render).result.picture));
  }
  Session session(wanted);
  const std::size_t count = std::size(changes);
  for (std::size_t step = 0; step < 3 * count; ++step) { // 3 and 5 have no factor of 8: other neighbours each time
    const std::size_t which = step * (step < count ? 1 : step < 2 * count ? 3 : 5) % count;
    EXPECT_EQ(all_bits(session.render(renders[which]).result.picture), alone[which]) << step << ", render " << which;
  }
}

TEST_F(SessionTest, AMaterialOfTheCatcher) {
  catcher_ = "own";
  Room other;
  other.own_color = {0.1, 0.9, 0.3, 1.0};
  expect_like({}, other,
              with_material(kOwnMaterial,
                            [](Material& m) {
                              m.base_color = {0.1f, 0.9f, 0.3f, 1.0f};
                            }),
              with_material(kOwnMaterial, [](Material& m) {
                m.base_color = {0.8f, 0.4f, 0.2f, 1.0f};
              }));
}

TEST_F(SessionTest, MotionGoesToTheCameraThatHoldsNow) {
  SessionRequest wanted = request({});
  wanted.render.settings.aovs = {"motion"};
  SessionRequest other = wanted;
  wanted.motion.next.camera = OtherCamera{.eye = {0.7, 2.0, 3.0}, .look_at = {0.1, 0.3, 0.0}};
  other.motion.next.camera = OtherCamera{.eye = {0.5, 2.2, 2.5}, .look_at = {0.0, 0.3, 0.1}};
  RenderRequest larger = wanted.render;
  larger.settings.width = 48;
  const auto all = [](Session& session, const RenderRequest& render) {
    return all_bits(session.render(render).result.picture);
  };
  Session first(wanted), second(other), session(wanted);
  const auto to_first = all(first, wanted.render), to_second = all(second, wanted.render);
  EXPECT_NE(to_first, to_second);
  EXPECT_EQ(all(session, wanted.render), to_first);
  EXPECT_EQ(all(session, larger), all(first, larger));
  session.set_motion(other.motion);
  EXPECT_EQ(all(session, wanted.render), to_second);
  other.scene.view.eye = glm::dvec3(0.4, 2.0, 3.0);
  session.set_view(other.scene.view);
  Session elsewhere(other);
  EXPECT_EQ(all(session, wanted.render), all(elsewhere, wanted.render));
  MotionRequest unknown;
  unknown.next.camera = OtherCamera{.camera = "no such camera"};
  EXPECT_THROW(session.set_motion(unknown), Error);
  EXPECT_EQ(all(session, wanted.render), all(elsewhere, wanted.render));
}

// A mesh that was added is there at other moments as well.
TEST_F(SessionTest, MotionOfAMeshThatIsAdded) {
  SessionRequest wanted = request({});
  wanted.render.settings.aovs = {"motion"};
  Session session(wanted);
  session.render(wanted.render);
  AddedMesh added;
  added.mesh.positions = {{-1, 1, 1}, {1, 1, 1}, {1, 1, -1}, {-1, 1, -1}};
  added.mesh.indices = {0, 1, 2, 0, 2, 3};
  added.mesh.primitives = {{0, 6, kOwnMaterial, false}};
  session.add_mesh(added);
  MotionRequest motion;
  motion.next.at = 1.0;
  session.set_motion(motion);
  const Picture picture = session.render(wanted.render).result.picture;
  for (const char* name : {"motion.X", "motion.Y"}) {
    const Channel* channel = find_channel(picture, name);
    ASSERT_TRUE(channel);
    for (const float value : channel->values) EXPECT_EQ(value, 0.0f);
  }
}

TEST_F(SessionTest, OrderOfEditsDoesNotMatter) {
  const SessionRequest wanted = request({});
  const Edit edits[] = {with_material(kOwnMaterial,
                                      [](Material& m) {
                                        m.emission = {1.0f, 1.0f, 0.0f};
                                      }),
                        [](Session& session) { session.set_matrix(kOwn, Room::place(0.4)); },
                        [](Session& session) { session.set_visible(kOtherTwin, false); },
                        [](Session& session) { session.set_environment({"0.1,0.2,0.3"}); }};
  Session forth(wanted), back(wanted);
  for (int i = 0; i < 4; ++i) {
    edits[i](forth);
    forth.update();
    edits[3 - i](back);
    bits(back, wanted.render);
  }
  EXPECT_EQ(bits(forth, wanted.render), bits(back, wanted.render));
}

TEST_F(SessionTest, RefusesWhatMakesNoSenseAndGoesOn) {
  const SessionRequest wanted = request({});
  Session session(wanted);
  const std::vector<float> first = bits(session, wanted.render);
  glm::dmat4 broken(1.0);
  broken[0][3] = 1.0;
  EXPECT_THROW(session.set_matrix(kOwn, broken), Error);
  EXPECT_THROW(session.set_matrix(99, glm::dmat4(1.0)), Error);
  EXPECT_THROW(session.set_visible(99, true), Error);
  EXPECT_THROW(session.set_material(99, {}), Error);
  EXPECT_THROW(session.set_environment({"no such file.exr"}), Error);
  EXPECT_THROW(session.set_image(0, {}), Error);
  EXPECT_THROW(session.remove_mesh(kOwn), Error);
  Material textured = session.scene().materials[kOwnMaterial];
  textured.base_color_texture.image = 7;
  EXPECT_THROW(session.set_material(kOwnMaterial, textured), Error);
  AddedMesh torn;
  torn.mesh.positions = {glm::vec3(0.0f)};
  torn.mesh.indices = {0, 1, 2};
  EXPECT_THROW(session.add_mesh(torn), Error);
  EXPECT_EQ(bits(session, wanted.render), first);
  Session one(request({}, SessionUse::one_picture));
  EXPECT_THROW(one.set_visible(kOwn, false), Error);
}

TEST_F(SessionTest, ARenderThatIsSteppedFollowsEdits) {
  Room shining;
  shining.own_emission = {1.0, 0.5, 0.25};
  SessionRequest wanted = request(shining);
  wanted.render.settings = as_told(wanted.render.settings);
  wanted.render.settings.kernels.mips = true; // as of a render that is stepped
  Session session(wanted);
  // What a session of its own gives.
  const auto expect_as_alone = [&](Progressive& render, const char* what) {
    SCOPED_TRACE(what);
    SessionRequest alone = wanted;
    alone.use = SessionUse::one_picture;
    Session other(alone);
    EXPECT_EQ(bits(render), bits(other, alone.render));
  };
  session.update();
  int gone = 0;
  Progressive& render = session.begin(wanted.render.settings, [&] { ++gone; });
  EXPECT_TRUE(session.update().redone.empty());
  expect_as_alone(render, "first");

  wanted.scene.view.eye = glm::dvec3(-0.5, 1.5, 2.0);
  session.set_view(wanted.scene.view);
  EXPECT_TRUE(session.update().redone.empty());
  EXPECT_TRUE(render.moving());
  expect_as_alone(render, "camera");

  wanted.render.settings.max_depth = 1;
  wanted.render.settings.width = 24;
  session.set_settings(wanted.render.settings);
  EXPECT_TRUE(session.update().redone.empty());
  expect_as_alone(render, "settings");
  EXPECT_EQ(gone, 0);

  wanted.render.settings.lights = gpu::kLightsTree;
  session.set_settings(wanted.render.settings);
  SessionUpdate update = session.update();
  EXPECT_TRUE(update.kept_geometry);
  EXPECT_TRUE(update.kept_surfaces);
  EXPECT_EQ(update.built_triangles, 0u);
  EXPECT_EQ(gone, 1);
  expect_as_alone(render, "settings that pack other lights");

  wanted.scene.environment = "sky";
  session.set_environment({"sky"});
  update = session.update();
  EXPECT_FALSE(update.redone.empty());
  EXPECT_TRUE(update.kept_geometry);
  EXPECT_EQ(gone, 2);
  expect_as_alone(render, "environment");
  EXPECT_TRUE(session.update().redone.empty());

  with_material(kOwnMaterial, [](Material& m) { m.emission = glm::vec3(0.0f); })(session);
  shining.own_emission = {0, 0, 0};
  wanted.scene.path = request(shining).scene.path;
  session.update();
  expect_as_alone(render, "material");
}

TEST_F(SessionTest, WhatAutoHasPackedIsNotPackedAgainByItsName) {
  for (const bool has_many : {false, true}) {
    SessionRequest wanted = request({});
    if (has_many) wanted.scene.path = moving_box_under_lamps(folder_, 40);
    ASSERT_EQ(wanted.render.settings.lights, gpu::kLightsAuto);
    Session session(wanted);
    session.update();
    EXPECT_EQ(usual_lights(session.packed()), has_many ? gpu::kLightsTree : gpu::kLightsPower);
    RenderRequest render = wanted.render;
    render.settings.lights = usual_lights(session.packed());
    EXPECT_TRUE(session.update(render).redone.empty());
    render.settings.lights = has_many ? gpu::kLightsPower : gpu::kLightsTree;
    EXPECT_FALSE(session.update(render).redone.empty());
  }
}

TEST_F(SessionTest, AnEnvironmentThatIsTakenBackLeavesNoTrace) {
  const std::function<void(SceneRequest&)> scenes[] = {[](SceneRequest&) {},
                                                       [](SceneRequest& scene) {
                                                         scene.environment.clear();
                                                         scene.ground = true;
                                                       }};
  for (const auto& change : scenes) {
    SessionRequest wanted = request({}, SessionUse::light);
    change(wanted.scene);
    Session session(wanted);
    const std::vector<float> first = bits(session, wanted.render);
    const Environment before = session.scene().environment;
    session.set_environment({"sky", 2.0});
    Environment other;
    other.radiance = glm::vec3(3.0f);
    session.set_environment(other);
    session.reset_environment();
    EXPECT_EQ(session.scene_request().environment, wanted.scene.environment);
    EXPECT_EQ(session.scene().environment.map, before.map);
    EXPECT_EQ(session.scene().environment.radiance, before.radiance);
    EXPECT_TRUE(session.update().redone.empty());
    EXPECT_EQ(bits(session, wanted.render), first);
    session.set_environment({"0.1,0.2,0.3"});
    session.reset_environment();
    session.reset_environment();
    EXPECT_TRUE(session.update().redone.empty());
    session.set_environment({"0.1,0.2,0.3"});
    const std::vector<float> second = bits(session, wanted.render);
    EXPECT_NE(second, first);
    session.reset_environment(); // the one that update() has done stays
    EXPECT_EQ(bits(session, wanted.render), second);
  }
}

TEST_F(SessionTest, ACutThatIsKeptLetsCamerasMove) {
  Room wide;
  wide.floor_scale = 1e4;
  for (const bool keeps : {true, false}) {
    SessionRequest wanted = request(wide, SessionUse::light);
    wanted.keeps_cut = keeps;
    Session session(wanted);
    session.update();
    ASSERT_GT(session.packed().cut.triangles, 0u);
    wanted.scene.view.eye = glm::dvec3(-100.0, 1.5, 2.0);
    session.set_view(wanted.scene.view);
    EXPECT_EQ(session.update().redone.empty(), keeps);
  }
}

TEST_F(SessionTest, KeepsNoMoreThanItIsOpenedFor) {
  const SessionRequest wanted = request({}, SessionUse::light);
  Session session(wanted);
  session.update();
  EXPECT_THROW(session.set_moment(1.0), Error);
  EXPECT_THROW(session.set_visible(kOwn, false), Error);
  session.set_environment({"sky"});
  EXPECT_TRUE(session.update().kept_geometry);
}

double resident_mib() {
  std::ifstream statm("/proc/self/statm");
  double all = 0.0, resident = 0.0;
  statm >> all >> resident;
  return resident * 4096.0 / 1048576.0;
}

TEST_F(SessionTest, ManyRendersTakeNoMoreMemory) {
  const SessionRequest wanted = request({});
  Session session(wanted);
  RenderRequest render = wanted.render;
  render.settings.width = render.settings.height = 8;
  const char* count = std::getenv("WAVEPATH_RENDERS"); // for measurements
  const int renders = count ? std::atoi(count) : 300;
  double before = 0.0;
  for (int i = 0; i < renders; ++i) {
    if (i == 100) before = resident_mib();
    ViewRequest view = wanted.scene.view;
    view.eye = glm::dvec3(0.5 + 0.001 * i, 2.0, 3.0);
    session.set_view(view);
    session.render(render);
  }
  EXPECT_LT(resident_mib() - before, 1.0);
  RecordProperty("mib", fmt::format("{:.2f}", resident_mib() - before));
}

// A floor whose material has a variant of another colour, one of another texture, and an animation of its factors.
std::string write_shop(const TempFolder& folder) {
  GltfBuilder b;
  const int positions = b.floats("VEC3", {-1, 0, 1, 1, 0, 1, 1, 0, -1, -1, 0, -1});
  const int uvs = b.floats("VEC2", {0, 0, 1, 0, 1, 1, 0, 1});
  const int indices = b.accessor("SCALAR", kUshort, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  b.add("images", {{"bufferView", b.view(std::string(kPng, sizeof(kPng) - 1))}});
  b.add("textures", {{"source", 0}});
  b.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0.8, 0.4, 0.2, 1}}}}});
  b.add("materials", {{"pbrMetallicRoughness", {{"baseColorFactor", {0.1, 0.8, 0.2, 1}}}}});
  b.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}});
  const nlohmann::json mappings = {{{"material", 1}, {"variants", {0}}}, {{"material", 2}, {"variants", {1}}}};
  b.mesh_node(
      {{"POSITION", positions}, {"TEXCOORD_0", uvs}},
      {{"indices", indices}, {"material", 0}, {"extensions", {{"KHR_materials_variants", {{"mappings", mappings}}}}}});
  b.root["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "green"}}, {{"name", "picture"}}};
  const nlohmann::json pointer = {{"pointer", "/materials/0/pbrMetallicRoughness/baseColorFactor"}};
  b.add(
      "animations",
      {{"samplers",
        {{{"input", b.floats("SCALAR", {0, 1})},
          {"output", b.floats("VEC4", {0.8f, 0.4f, 0.2f, 1, 0.2f, 0.4f, 0.8f, 1})}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", pointer}}}}}}}}});
  return folder.write("shop.glb", b.glb()).string();
}

TEST_F(SessionTest, VariantsOfMaterials) {
  const std::string path = write_shop(folder_);
  const auto wanted = [&](SessionUse use, const char* variant) {
    SessionRequest r = request({}, use);
    r.scene.path = path;
    r.scene.load.variant = variant;
    return r;
  };
  const auto shown = [&](const char* variant) {
    const SessionRequest r = wanted(SessionUse::one_picture, variant);
    Session session(r);
    return bits(session, r.render);
  };
  const std::vector<float> none = shown(""), green = shown("green"), picture = shown("picture");
  EXPECT_NE(none, green);
  EXPECT_NE(none, picture);
  for (const SessionUse use : {SessionUse::light, SessionUse::poses, SessionUse::edits}) {
    const SessionRequest r = wanted(use, "");
    Session session(r);
    EXPECT_EQ(bits(session, r.render), none);
    session.set_variant("picture");
    EXPECT_EQ(bits(session, r.render), picture) << "its texture is read then, if it was not before";
    session.set_variant("green");
    EXPECT_EQ(bits(session, r.render), green);
    const SessionPicture told = session.render(r.render);
    EXPECT_NE(told.repeat.find("--variant green"), std::string::npos) << told.repeat;
    session.set_variant("");
    EXPECT_EQ(bits(session, r.render), none);
    EXPECT_THROW(session.set_variant("red"), Error);
    EXPECT_EQ(bits(session, r.render), none);
  }
  const SessionRequest r = wanted(SessionUse::one_picture, "");
  Session session(r);
  EXPECT_THROW(session.set_variant("green"), Error) << "nothing is kept for it";
}

TEST_F(SessionTest, MomentsOfAnimatedMaterials) {
  const std::string path = write_shop(folder_);
  const auto wanted = [&](SessionUse use, double at) {
    SessionRequest r = request({}, use);
    r.scene.path = path;
    r.scene.load.animation = "0";
    r.scene.load.at = at;
    return r;
  };
  const SessionRequest r = wanted(SessionUse::poses, 0.0);
  Session session(r);
  std::vector<float> before = bits(session, r.render);
  for (const double at : {0.5, 1.0, 0.25}) {
    const SessionRequest other = wanted(SessionUse::one_picture, at);
    Session alone(other);
    session.set_moment(at);
    const std::vector<float> now = bits(session, r.render);
    EXPECT_EQ(now, bits(alone, other.render)) << at;
    EXPECT_NE(now, before);
    before = now;
  }
}

} // namespace
} // namespace wavepath::test
