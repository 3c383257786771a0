// Textures of more than one buffer: kernels find every word, and a picture does not tell where its texels lie.
#include <vector>

#include "host/film/film.h"
#include "host/render/render.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"
#include "kernels/base/features.h"
#include "kernels/base/scene_types.h"
#include "tests/probe.h"
#include "tests/scene_builder.h"
#include "tests/shared_kernels.h"

#include "tests/probes/texel_pages_probe.spv.h"

namespace wavepath::test {
namespace {

constexpr std::uint32_t kPage = 1u << gpu::kTexelPageShift;

class TexelPages : public VulkanTest {
protected:
  // What kernels with these features read where page p holds 1000 p, 1000 p + 1, ...
  std::vector<std::uint32_t> read(const std::vector<std::uint32_t>& words, gpu::Feature features) {
    std::vector<Buffer> pages;
    for (std::uint32_t p = 0; p < gpu::kTexelPages; ++p) {
      std::vector<std::uint32_t> page(100);
      for (std::uint32_t i = 0; i < page.size(); ++i) page[i] = 1000 * p + i;
      pages.push_back(upload(device(), page));
    }
    const Buffer in_out = upload(device(), words);
    std::vector<Binding> bindings{{0, BindingKind::storage, &in_out}};
    for (std::uint32_t p = 0; p < pages.size(); ++p)
      bindings.push_back(
          {p == 0 ? gpu::kBindTexels : gpu::kBindTexelPages + p - 1, BindingKind::texels_r32ui, &pages[p]});
    const auto count = static_cast<std::uint32_t>(words.size());
    const BindingSet set(device(), bindings, sizeof count);
    std::vector<std::uint32_t> constants(gpu::kSpecCount);
    constants[gpu::kSpecFeatures] = static_cast<std::uint32_t>(features);
    constants[gpu::kSpecLobes] = static_cast<std::uint32_t>(features >> 32);
    const Kernel kernel(device(), "texel_pages_probe", wavepath_texel_pages_probe_spv, set, constants);
    Commands commands(device());
    commands.bind(set);
    commands.dispatch(kernel, groups_for(count), &count);
    commands.submit_and_wait();
    return download<std::uint32_t>(in_out, words.size());
  }
};

TEST_F(TexelPages, EveryPageIsFound) {
  const std::vector<std::pair<gpu::Feature, std::uint32_t>> builds = {
      {0, 1},
      {gpu::kFeatureTexelPages2, 2},
      {gpu::kFeatureTexelPages2 | gpu::kFeatureTexelPages4, 4},
      {gpu::kFeatureTexelPages, gpu::kTexelPages}};
  for (const auto& [features, pages] : builds) {
    std::vector<std::uint32_t> asked, expected;
    for (std::uint32_t i = 0; i < 64; ++i) { // neighbours in different pages
      const std::uint32_t page = (i * 7) % pages;
      asked.push_back((page << gpu::kTexelPageShift) + i);
      expected.push_back(1000 * page + i);
    }
    EXPECT_EQ(read(asked, features), expected) << pages;
  }
}

// A floor of 16x16 texels of all colours, seen from above.
Scene colourful_floor() {
  Scene scene;
  scene.path = "test";
  scene.materials.push_back(plain_material());
  Image image{"colours", 16, 16, {}, {}};
  for (std::uint32_t i = 0; i < 16 * 16 * 4; ++i) image.bytes.push_back(i % 4 == 3 ? 255 : (i * 37 + i / 16) & 255);
  scene.images.push_back(image);
  scene.materials[0].base_color = glm::vec4(1.0f);
  scene.materials[0].base_color_texture.image = 0;
  add_instance(scene, add_mesh(scene, {{-1, 0, 1}, {1, 0, 1}, {1, 0, -1}, {-1, 0, 1}, {1, 0, -1}, {-1, 0, -1}}));
  scene.meshes[0].uvs[0] = {{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  scene.environment.radiance = glm::vec3(1.0f);
  Camera camera;
  camera.world_from_camera = {{1, 0, 0, 0}, {0, 0, -1, 0}, {0, 1, 0, 0}, {0, 4, 0, 1}}; // looks along -y
  camera.yfov = 0.43;
  scene.cameras.push_back(camera);
  return scene;
}

// The image begins in one page and ends in the next.
TEST_F(TexelPages, APictureDoesNotTellWhereItsTexelsLie) {
  Scene scene = colourful_floor();
  RenderPlan settings = RenderSettings{.width = 32, .height = 32, .last_sample = 2, .max_depth = 1};
  const View view = resolve_view(scene, {}, settings.width, settings.height);
  PackedScene packed = pack(scene);
  ASSERT_EQ(packed.features & gpu::kFeatureTexelPages, 0u);
  const auto film = [&] {
    return render(device(), packed, view, settings, RenderHooks{}, shared_kernels(device())).film;
  };
  const auto expected = film();
  packed.texels.insert(packed.texels.begin(), kPage - 100, 0u);
  for (gpu::Texture& texture : packed.textures) texture.first_texel += kPage - 100;
  packed.features |= gpu::kFeatureTexelPages2;
  EXPECT_TRUE(*film() == *expected);
  settings.specialize = false;
  EXPECT_TRUE(*film() == *expected) << "generic kernels know as many pages as there are";
}

} // namespace
} // namespace wavepath::test
