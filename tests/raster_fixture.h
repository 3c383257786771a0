// Draws rectangles whose edges are pixel edges into pictures of 8x8 pixels, so that every value is known exactly.
#pragma once

#include <array>
#include <cstring>
#include <optional>
#include <span>
#include <vector>

#include "host/gpu/raster.h"
#include "tests/probe.h"
#include "tests/probes/raster_rectangle_frag.spv.h"
#include "tests/probes/raster_rectangle_vert.spv.h"

namespace wavepath::test {

inline constexpr std::uint32_t kSize = 8, kPixels = kSize * kSize;
using Colour = std::array<float, 4>;

// Pixels first_x <= x < last_x, likewise y. Front faces are counter-clockwise as the picture shows them.
struct Rectangle {
  std::uint32_t first_x, first_y, last_x, last_y;
  float depth;
  Colour colour{};
  bool front = true;

  bool covers(std::uint32_t pixel) const {
    const std::uint32_t x = pixel % kSize, y = pixel / kSize;
    return x >= first_x && x < last_x && y >= first_y && y < last_y;
  }
};

struct Corner {
  Colour position, colour;
};

inline std::vector<Corner> corners_of(std::span<const Rectangle> rectangles) {
  std::vector<Corner> corners;
  const auto clip = [](std::uint32_t pixel) { return 2.0f * static_cast<float>(pixel) / kSize - 1.0f; };
  for (const Rectangle& r : rectangles) {
    const float left = clip(r.first_x), top = clip(r.first_y), right = clip(r.last_x), bottom = clip(r.last_y);
    const auto add = [&](float x, float y) { corners.push_back({{x, y, r.depth, 1.0f}, r.colour}); };
    for (int triangle = 0; triangle < 2; ++triangle) {
      const float x = triangle ? right : left, y = triangle ? bottom : top;
      // Two of the diagonal's ends and the corner (x, y) of one side of it; the order decides which side faces us.
      add(x, y);
      const bool swap = (triangle == 0) != r.front;
      swap ? add(right, top) : add(left, bottom);
      swap ? add(left, bottom) : add(right, top);
    }
  }
  return corners;
}

// The first `count` rectangles from the `first` on.
inline VertexRange range(std::uint32_t first, std::uint32_t count = 1) { return {6 * first, 6 * count}; }

inline const RasterCode kColoured{"rectangle", wavepath_raster_rectangle_vert_spv, wavepath_raster_rectangle_frag_spv};
inline const RasterCode kDepthOnly{"rectangle", wavepath_raster_rectangle_vert_spv, {}};
inline const RasterState kLess{.depth = {.compare = Compare::less}};

class RasterTest : public VulkanTest {
protected:
  void SetUp() override {
    VulkanTest::SetUp();
    if (!IsSkipped() && !device().rasterizes()) GTEST_SKIP() << "a queue that cannot rasterize";
  }

  // The rectangles on the device, for kDraws.
  void place(std::span<const Rectangle> rectangles) {
    corners_ = upload(device(), corners_of(rectangles));
    const Binding binding{.slot = 0, .kind = BindingKind::storage, .buffer = &corners_};
    bindings_.emplace(device(), std::span(&binding, 1), 0u, BindingSet::kRasterStages);
  }
  RasterPipeline pipeline(const RasterCode& code, std::span<const AttachmentInfo> attachments,
                          const RasterState& state) {
    return {device(), code, attachments, state, *bindings_, {}};
  }
  RasterDraw draw(const RasterPipeline& pipeline, const VertexRange& rectangles) {
    return {.pipeline = &pipeline, .bindings = &*bindings_, .ranges = {&rectangles, 1}};
  }
  // Reads all layers of an image through a mapped buffer, as a loop does that does not wait.
  template <class T>
  std::vector<T> read(DeviceImage& image, Aspect aspect = Aspect::main) {
    std::vector<T> texels(std::size_t{image.info().width} * image.info().height * image.info().layers);
    EXPECT_EQ(sizeof(T), texel_bytes(image.info().format, aspect));
    Buffer buffer(device(), texels.size() * sizeof(T), BufferHome::readback);
    Commands commands(device());
    image.copy_to(commands.handle(), buffer, aspect);
    commands.submit_and_wait();
    buffer.invalidate();
    std::memcpy(texels.data(), buffer.mapped(), buffer.bytes());
    return texels;
  }
  void run(const KernelCode& code, std::span<const Binding> bindings, std::uint32_t count) {
    const BindingSet set(device(), bindings, sizeof(count));
    const Kernel kernel(device(), code, set, {});
    Commands commands(device());
    commands.bind(set);
    commands.dispatch(kernel, groups_for(count), &count);
    commands.submit_and_wait();
  }

  Buffer corners_;
  std::optional<BindingSet> bindings_;
};

inline const std::array<AttachmentInfo, 3> kGbuffer{
    {{.name = "colour",
      .format = ImageFormat::rgba32f,
      .sampled = true,
      .clear = {.colour = {0.1f, 0.2f, 0.3f, -4.0f}}},
     {.name = "depth", .format = ImageFormat::depth32f, .sampled = true, .clear = {.depth = 0.125f}},
     {.name = "number", .format = ImageFormat::r32ui, .sampled = true, .clear = {.words = {0xdeadbeefu}}}}};

inline constexpr std::array<Rectangle, 3> kOverlapping{{{0, 0, 4, 8, 0.5f, {1e-20f, 3.5f, -2.0f, 1e20f}},
                                                        {0, 0, 8, 4, 0.25f, {0.5f, 0.25f, 1.0f / 3.0f, 1.0f}},
                                                        {6, 2, 8, 6, 0.5f, {7.0f, 8.0f, 9.0f, 10.0f}}}};

} // namespace wavepath::test
