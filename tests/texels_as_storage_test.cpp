// Devices of small texel buffers: kernels that read storage blocks instead tell the same, and scenes fit.
#include "host/gpu/texels_as_storage.h"

#include <algorithm>
#include <numeric>

#include "host/base/error.h"
#include "host/film/film.h"
#include "host/render/render.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "kernels/base/scene_types.h"
#include "kernels/path/extend.spv.h"
#include "tests/emulate.h"
#include "tests/probe.h"
#include "tests/scene_builder.h"

#include "tests/probes/texel_kinds_probe.spv.h"

namespace wavepath::test {
namespace {

const char* wanted_device() { return std::getenv("WAVEPATH_DEVICE") ? std::getenv("WAVEPATH_DEVICE") : ""; }

// Texel buffers of every kind.
std::vector<Binding> all_kinds(const Buffer& words, bool is_small) {
  using enum BindingKind;
  std::vector<Binding> bindings;
  for (const BindingKind kind : {texels_rgba32f, texels_rgba32ui, texels_rg32ui, texels_r32ui, texels_r32f})
    bindings.push_back({.slot = static_cast<std::uint32_t>(bindings.size() + 1),
                        .kind = kind,
                        .buffer = &words,
                        .is_small = is_small});
  return bindings;
}

std::vector<std::uint32_t> read_all_kinds(Device& device, bool is_small) {
  constexpr std::uint32_t kCount = 5, kWords = 21;
  std::vector<std::uint32_t> words(4 * kCount);
  std::iota(words.begin(), words.end(), 0x3f800000u);
  const Buffer in = upload(device, words), out = upload(device, std::vector<std::uint32_t>(kCount * kWords));
  std::vector<Binding> bindings = all_kinds(in, is_small);
  bindings.push_back({0, BindingKind::storage, &out});
  const BindingSet set(device, bindings, sizeof kCount);
  EXPECT_EQ(set.storage_texels().size(), !is_small && device.info().has_few_texels ? 5u : 0u);
  const Kernel kernel(device, "texel kinds", wavepath_texel_kinds_probe_spv, set, {});
  Commands commands(device);
  commands.bind(set);
  commands.dispatch(kernel, 1, &kCount);
  commands.submit_and_wait();
  return download<std::uint32_t>(out, kCount * kWords);
}

class TexelsAsStorage : public VulkanTest {};

TEST_F(TexelsAsStorage, EveryKindReadsAlike) {
  const auto expected = read_all_kinds(device(), false);
  EXPECT_EQ(expected[4 * 2 + 0], 0x3f800000u) << "the probe reads";
  const Emulate emulate("few-texels");
  Device few(wanted_device());
  ASSERT_TRUE(few.info().has_few_texels);
  EXPECT_EQ(read_all_kinds(few, false), expected);
  EXPECT_EQ(read_all_kinds(few, true), expected);
}

TEST_F(TexelsAsStorage, OnlyWhatIsNamedIsRewritten) {
  const std::vector<std::uint32_t> whole(std::begin(wavepath_extend_spv), std::end(wavepath_extend_spv));
  EXPECT_EQ(texels_as_storage(whole, {}), whole);
  EXPECT_EQ(texels_as_storage(whole, std::vector<StorageTexels>{{999, 4}}), whole) << "it has no such binding";
  EXPECT_NE(texels_as_storage(whole, std::vector<StorageTexels>{{gpu::kBindNodes, 4}}), whole);
}

// 80,000 triangles, 90,000 texels, and a map of as many that is searched for a few steps or for many.
Scene large_scene() {
  constexpr int kSide = 200;
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  Image image{"noise", 300, 300, {}, {}};
  for (std::uint32_t i = 0; i < 300 * 300 * 4; ++i) image.bytes.push_back(i % 4 == 3 ? 255 : (i * 37 + i / 1200) & 255);
  scene.images.push_back(image);
  scene.materials[0].base_color = glm::vec4(1.0f);
  scene.materials[0].base_color_texture.image = 0;
  std::vector<glm::vec3> corners;
  std::vector<glm::vec2> uvs;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x)
      for (const glm::ivec2 corner : {glm::ivec2(0, 0), {0, 1}, {1, 1}, {0, 0}, {1, 1}, {1, 0}}) {
        const glm::vec2 at = (glm::vec2(x, y) + glm::vec2(corner)) / static_cast<float>(kSide);
        corners.emplace_back(2.0f * at.x - 1.0f, 0.1f * glm::sin(40.0f * at.x) * glm::sin(30.0f * at.y),
                             2.0f * at.y - 1.0f);
        uvs.push_back(at);
      }
  add_instance(scene, add_mesh(scene, corners));
  scene.meshes[0].uvs[0] = uvs;
  scene.environment.radiance = glm::vec3(1.0f);
  scene.environment.width = 450;
  scene.environment.height = 200;
  for (int i = 0; i < 450 * 200; ++i)
    scene.environment.map.emplace_back(i % 450 < 30 ? 20.0f : 0.1f + 0.01f * static_cast<float>(i % 7));
  Camera camera;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 4, 0, 1}}; // looks along -y
  camera.yfov = 0.43;
  scene.cameras.push_back(camera);
  return scene;
}

TEST_F(TexelsAsStorage, AScenePastTheLimitRendersToTheSameBits) {
  Scene scene = large_scene();
  const PackedScene packed = pack(scene);
  const Emulate emulate("few-texels");
  Device few(wanted_device());
  ASSERT_GT(packed.triangles.size() * sizeof(packed.triangles[0]), 16 * few.info().max_texel_elements);
  ASSERT_GT(packed.texels.size(), few.info().max_texel_elements);
  for (const char* name : {"path", "bidirectional", "hybrid", "whitted"}) {
    SCOPED_TRACE(name);
    RenderPlan settings = RenderSettings{.width = 48, .height = 32, .last_sample = 2, .max_depth = 2};
    settings.integrator = find_integrator(name);
    const View view = resolve_view(scene, {}, settings.width, settings.height);
    const auto film = [&](Device& on) {
      KernelCompiler kernels(on);
      return render(on, packed, view, settings, RenderHooks{}, kernels).film;
    };
    EXPECT_TRUE(*film(few) == *film(device()));
  }
}

} // namespace
} // namespace wavepath::test
