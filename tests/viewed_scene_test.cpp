// What the user of a window changes has nothing redone but what it touches, and what fails leaves all as it was.
#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "host/base/error.h"
#include "host/plan/plan.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/pack/light_groups.h"
#include "host/session/resolve.h"
#include "host/session/session.h"
#include "host/session/viewing/viewed_scene.h"
#include "tests/gltf_builder.h"
#include "tests/vulkan_device.h"

namespace wavepath::test {
namespace {

const std::string kBox = WAVEPATH_SOURCE_DIR "/scenes/cornell_box.gltf";

class ViewedSceneTest : public VulkanTest {
protected:
  void open(const std::string& file, const std::string& integrator = "path", std::vector<std::string> groups = {}) {
    SceneRequest scene;
    scene.path = file;
    scene.view = camera_;
    scene.environment = "0.5,0.5,0.5";
    RenderRequest render;
    RenderPlan& settings = render.settings;
    read_setting(setting_named("integrator"), integrator, settings);
    settings.width = 40, settings.height = 30;
    settings.sample_total = 2;
    settings.max_depth = 2;
    settings.light_groups = std::move(groups);
    settings.aovs = {"direct"};
    render.given = {"integrator"};
    resolve_settings(scene, render);
    SessionRequest wanted = session_request(scene, render);
    wanted.device.device = std::shared_ptr<Device>(&device(), [](Device*) {});
    wanted.device.kernels = std::make_shared<KernelCompiler>(device());
    scene_.reset();
    session_ = std::make_unique<Session>(wanted);
    RenderPlan plan = as_told(settings);
    plan.group_names = find_group_names(session_->scene(), plan.light_groups);
    scene_ = std::make_unique<ViewedScene>(*session_, plan);
  }
  ViewRequest elsewhere() const {
    ViewRequest camera = camera_;
    const View view = session_->view(40, 30);
    camera.eye = view.position + 0.2 * view.right + 0.1 * view.forward;
    return camera;
  }
  std::vector<float> picture() {
    scene_->rest();
    const ShadowComparison* comparison = scene_->comparison();
    while (!scene_->render().is_done() || (comparison && !comparison->is_done()))
      if (!scene_->step()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::vector<float> values;
    for (const Channel& channel : scene_->render().picture().channels)
      values.insert(values.end(), channel.values.begin(), channel.values.end());
    return values;
  }

  ViewRequest camera_; // to begin with
  std::unique_ptr<Session> session_;
  std::unique_ptr<ViewedScene> scene_;
};

// Triangles so huge would be cut anew for every camera.
std::string write_wide_floor(const TempFolder& folder) {
  GltfBuilder b;
  const int positions = b.floats("VEC3", {-1e4, 0, 1e4, 1e4, 0, 1e4, 1e4, 0, -1e4, -1e4, 0, -1e4});
  const int indices = b.accessor("SCALAR", kUshort, std::vector<std::uint16_t>{0, 1, 2, 0, 2, 3});
  b.add("meshes", {{"primitives", {{{"attributes", {{"POSITION", positions}}}, {"indices", indices}}}}});
  b.add("nodes", {{"mesh", 0}});
  b.root["scenes"] = {{{"nodes", {0}}}};
  return folder.write("floor.glb", b.glb()).string();
}

TEST_F(ViewedSceneTest, ACameraThatMovesHasNothingRedone) {
  const TempFolder folder;
  const std::string floor = write_wide_floor(folder);
  for (const std::string& file : {kBox, floor}) {
    SCOPED_TRACE(file);
    if (file == floor) camera_.eye = glm::dvec3(0.0, 2.0, 5.0), camera_.look_at = glm::dvec3(0.0, 1.5, 0.0);
    open(file);
    EXPECT_EQ(session_->packed().cut.triangles > 0, file == floor);
    const std::vector<float> here = picture();
    const DeviceScene* on_device = &scene_->render().device_scene();
    EXPECT_TRUE(scene_->move(elsewhere()).redone.empty());
    EXPECT_TRUE(scene_->render().moving());
    const std::vector<float> there = picture();
    EXPECT_NE(there, here);
    EXPECT_TRUE(scene_->move(camera_).redone.empty());
    EXPECT_EQ(picture(), here);
    EXPECT_EQ(&scene_->render().device_scene(), on_device);
  }
}

TEST_F(ViewedSceneTest, AnEnvironmentLeavesTheGeometry) {
  open(kBox);
  const std::vector<float> grey = picture();
  const SessionUpdate update = scene_->set_environment({"sky", 1.0, 30.0});
  EXPECT_FALSE(update.redone.empty());
  EXPECT_TRUE(update.kept_geometry);
  EXPECT_EQ(session_->scene_request().environment, "sky");
  const std::vector<float> sky = picture();
  EXPECT_NE(sky, grey);
  EXPECT_TRUE(scene_->move(elsewhere()).redone.empty());
  EXPECT_TRUE(scene_->move(camera_).redone.empty());
  EXPECT_EQ(picture(), sky);
  EXPECT_TRUE(scene_->set_environment({"0.5,0.5,0.5"}).kept_geometry);
  EXPECT_EQ(picture(), grey);
}

TEST_F(ViewedSceneTest, SettingsHaveNothingRedoneButTheLightsThatTheyAskFor) {
  open(kBox);
  const std::vector<float> before = picture();
  const RenderPlan first = scene_->render().settings();
  RenderPlan other = first;
  other.max_depth = 1;
  other.seed = 7;
  other.width = 52, other.height = 20;
  other.sampler = gpu::kSamplerStratified;
  EXPECT_TRUE(scene_->set_settings(other, camera_).redone.empty());
  EXPECT_EQ(scene_->render().settings().width, 52u);
  EXPECT_NE(picture(), before);
  other = first;
  other.lights = gpu::kLightsTree;
  const SessionUpdate update = scene_->set_settings(other, camera_);
  EXPECT_FALSE(update.redone.empty());
  EXPECT_TRUE(update.kept_geometry);
  EXPECT_TRUE(update.kept_surfaces);
  picture();
  scene_->set_settings(first, camera_);
  EXPECT_EQ(picture(), before);
}

// The lights that `hybrid` samples for its shadows are not those of `path`.
TEST_F(ViewedSceneTest, AnotherIntegratorGivesThePictureOfAWindowOfItsOwn) {
  const auto shadowed = [&] {
    RenderPlan settings = scene_->render().settings();
    read_setting(setting_named("shadows"), "map", settings);
    settings.shadow_size = 64;
    return settings;
  };
  open(kBox, "hybrid");
  scene_->set_settings(shadowed(), camera_);
  const std::vector<float> hybrid = picture();
  open(kBox);
  const std::vector<float> path = picture();
  const RenderPlan first = scene_->render().settings();
  RenderPlan settings = shadowed();
  read_setting(setting_named("integrator"), "hybrid", settings);
  EXPECT_TRUE(scene_->set_settings(settings, camera_).kept_geometry);
  EXPECT_EQ(picture(), hybrid);
  EXPECT_TRUE(scene_->set_settings(first, camera_).kept_geometry);
  EXPECT_EQ(picture(), path);
}

TEST_F(ViewedSceneTest, WhatFailsLeavesAllAsItWas) {
  open(kBox, "path", {kEachLight});
  const std::vector<float> before = picture();
  EXPECT_THROW(scene_->set_environment({"no such file.exr"}), Error);
  EXPECT_TRUE(scene_->move(camera_).redone.empty());
  EXPECT_EQ(picture(), before);
  EXPECT_THROW(scene_->set_environment({"black"}), Error); // which is no group
  EXPECT_EQ(session_->scene_request().environment, "0.5,0.5,0.5");
  EXPECT_TRUE(scene_->move(camera_).redone.empty());
  EXPECT_EQ(picture(), before);
  const RenderPlan first = scene_->render().settings();
  RenderPlan refused = first; // what `render` refuses in one line
  read_setting(setting_named("integrator"), "hybrid", refused);
  read_setting(setting_named("antialias"), "beam", refused);
  refused.aovs = {"depth"};
  EXPECT_THROW(scene_->set_settings(refused, elsewhere()), Error);
  EXPECT_EQ(scene_->render().settings().integrator, first.integrator);
  scene_->move(camera_);
  EXPECT_EQ(picture(), before);
  for (const std::uint32_t lights : {first.lights, gpu::kLightsTree}) { // which have nothing packed, or lights
    RenderPlan larger = first;
    larger.lights = lights;
    larger.width = larger.height = 1u << 20;
    EXPECT_THROW(scene_->set_settings(larger, elsewhere()), Error);
    EXPECT_EQ(scene_->render().settings().width, first.width);
    scene_->move(camera_);
    EXPECT_EQ(picture(), before);
  }
}

TEST_F(ViewedSceneTest, AComparisonGoesWithTheSceneThatItIsOf) {
  open(kBox, "hybrid");
  RenderPlan settings = scene_->render().settings();
  read_setting(setting_named("shadows"), "map", settings);
  settings.shadow_size = 64;
  scene_->set_settings(settings, camera_);
  scene_->compare(0);
  const std::vector<float> before = picture();
  EXPECT_TRUE(scene_->move(elsewhere()).redone.empty());
  ASSERT_TRUE(scene_->comparison());
  picture();
  const View &ours = scene_->render().view(), &theirs = scene_->comparison()->truth().view();
  EXPECT_EQ(ours.position, theirs.position);
  EXPECT_TRUE(scene_->move(camera_).redone.empty());
  settings.max_depth = 1;
  EXPECT_TRUE(scene_->set_settings(settings, camera_).redone.empty());
  ASSERT_TRUE(scene_->comparison());
  EXPECT_EQ(scene_->comparison()->truth().settings().max_depth, 1u);
  settings.max_depth = 2;
  scene_->set_settings(settings, camera_);
  EXPECT_EQ(picture(), before);
  EXPECT_TRUE(scene_->set_environment({"0.1,0.2,0.3"}).kept_geometry);
  EXPECT_FALSE(scene_->comparison());
  scene_->compare(0);
  EXPECT_NE(picture(), before);
}

} // namespace
} // namespace wavepath::test
