// Rasterization into attachments of several formats: depth and stencil tests, culling, bias, and what passes keep.
#include "tests/raster_fixture.h"

namespace wavepath::test {
namespace {

// Greater depth wins: the first rectangle keeps its half where the second one lies behind it.
TEST_F(RasterTest, AttachmentsOfThreeFormatsAreDrawnAtOnce) {
  place(kOverlapping);
  RasterTarget target(device(), kSize, kSize, kGbuffer);
  const RasterPipeline pass = pipeline(kColoured, kGbuffer, {});
  Commands commands(device());
  const VertexRange all = range(0, 3);
  const RasterDraw one = draw(pass, all);
  target.draw(commands, {.draws = {&one, 1}});
  commands.submit_and_wait();
  const auto colours = read<Colour>(target.image(0));
  const auto depths = read<float>(target.image(1));
  const auto numbers = read<std::uint32_t>(target.image(2));
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    const Rectangle* seen = nullptr;
    for (const Rectangle& r : kOverlapping)
      if (r.covers(pixel) && (!seen || r.depth > seen->depth)) seen = &r;
    EXPECT_EQ(colours[pixel], seen ? seen->colour : kGbuffer[0].clear.colour) << pixel;
    EXPECT_EQ(depths[pixel], seen ? seen->depth : 0.125f) << pixel;
    EXPECT_EQ(numbers[pixel], seen ? static_cast<std::uint32_t>(seen - kOverlapping.data()) : 0xdeadbeefu) << pixel;
  }
  EXPECT_GE(target.bytes(), kPixels * (16u + 4u + 4u));
}

// The second pass goes by the depth that the first one left, and clears colours alone.
TEST_F(RasterTest, PassesKeepWhatTheyDoNotClear) {
  place(kOverlapping);
  RasterTarget target(device(), kSize, kSize, kGbuffer);
  const RasterPipeline pass = pipeline(kColoured, kGbuffer, {});
  Commands commands(device());
  const VertexRange first = range(0), second = range(1);
  const RasterDraw before = draw(pass, first), after = draw(pass, second);
  target.draw(commands, {.draws = {&before, 1}});
  target.draw(commands, {.draws = {&after, 1}, .clear = kClearColour});
  commands.submit_and_wait();
  const auto depths = read<float>(target.image(1));
  const auto numbers = read<std::uint32_t>(target.image(2));
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    const bool left = kOverlapping[0].covers(pixel), top = kOverlapping[1].covers(pixel);
    EXPECT_EQ(depths[pixel], left ? 0.5f : top ? 0.25f : 0.125f) << pixel;
    EXPECT_EQ(numbers[pixel], top && !left ? 1u : 0xdeadbeefu) << pixel;
  }
}

// Two targets share a depth image: what the second draws is hidden by what the first did.
TEST_F(RasterTest, TargetsShareAnImage) {
  place(kOverlapping);
  const std::array<AttachmentInfo, 1> prepass{{kGbuffer[1]}};
  RasterTarget depth_target(device(), kSize, kSize, prepass);
  std::array<AttachmentInfo, 3> attachments = kGbuffer;
  attachments[1].shared = &depth_target.image(0);
  RasterTarget target(device(), kSize, kSize, attachments);
  const RasterPipeline depth_pass = pipeline(kDepthOnly, prepass, {});
  const RasterPipeline colour_pass =
      pipeline(kColoured, attachments, {.depth = {.write = false, .compare = Compare::equal}});
  const VertexRange all = range(0, 3);
  const RasterDraw before = draw(depth_pass, all), after = draw(colour_pass, all);
  Commands commands(device());
  depth_target.draw(commands, {.draws = {&before, 1}});
  target.draw(commands, {.draws = {&after, 1}, .clear = kClearColour});
  commands.submit_and_wait();
  const auto numbers = read<std::uint32_t>(target.image(2));
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    const bool left = kOverlapping[0].covers(pixel), right = kOverlapping[2].covers(pixel);
    const bool top = kOverlapping[1].covers(pixel);
    EXPECT_EQ(numbers[pixel], left ? 0u : right ? 2u : top ? 1u : 0xdeadbeefu) << pixel;
  }
  EXPECT_LT(depth_target.bytes(), target.bytes());
}

TEST_F(RasterTest, CullingGoesByTheOrderOfCorners) {
  const std::array<Rectangle, 2> rectangles{{{0, 0, 4, 8, 0.5f}, {4, 0, 8, 8, 0.5f, {}, false}}};
  place(rectangles);
  const VertexRange all = range(0, 2);
  for (const Cull cull : {Cull::none, Cull::front, Cull::back}) {
    RasterTarget target(device(), kSize, kSize, kGbuffer);
    const RasterPipeline pass = pipeline(kColoured, kGbuffer, {.cull = cull});
    const RasterDraw one = draw(pass, all);
    Commands commands(device());
    target.draw(commands, {.draws = {&one, 1}});
    commands.submit_and_wait();
    const auto numbers = read<std::uint32_t>(target.image(2));
    EXPECT_EQ(numbers[0] == 0u, cull != Cull::front);
    EXPECT_EQ(numbers[kPixels - 1] == 1u, cull != Cull::back);
  }
}

// The unit of the bias is the resolution of a float between 0.5 and 1, which is 2^-24.
TEST_F(RasterTest, DepthBiasMovesDepths) {
  const std::array<AttachmentInfo, 1> attachments{
      {{.name = "shadow map", .format = ImageFormat::depth32f, .clear = {.depth = 1.0f}}}};
  const std::array<Rectangle, 1> rectangles{{{0, 0, 4, 8, 0.5f}}};
  place(rectangles);
  RasterTarget target(device(), kSize, kSize, attachments);
  const RasterPipeline pass =
      pipeline(kDepthOnly, attachments, {.depth = {.compare = Compare::less, .bias = 0x1p20f, .slope_bias = 2.0f}});
  const VertexRange all = range(0);
  const RasterDraw one = draw(pass, all);
  Commands commands(device());
  target.draw(commands, {.draws = {&one, 1}});
  commands.submit_and_wait();
  const auto depths = read<float>(target.image(0));
  EXPECT_EQ(depths[0], 0.5f + 0x1p-4f);
  EXPECT_EQ(depths[kSize - 1], 1.0f);
}

// Shadow volumes, z-pass: front faces before the floor add one, back faces before it take one away; where the count is
// not zero there is shadow.
class StencilTest : public RasterTest {
protected:
  static constexpr float kFloor = 0.5f, kBefore = 0.25f, kBehind = 0.75f;
  const std::array<AttachmentInfo, 3> attachments_{
      {{.name = "colour", .format = ImageFormat::rgba32f},
       {.name = "number", .format = ImageFormat::r32ui, .clear = {.words = {9}}},
       {.name = "depth and stencil",
        .format = ImageFormat::depth32f_stencil8,
        .sampled = true,
        .clear = {.depth = 1.0f, .stencil = 0}}}};
  const RasterState count_{.depth = {.write = false, .compare = Compare::less},
                           .stencil = StencilState{.front = {.pass = StencilOp::increment_wrap},
                                                   .back = {.pass = StencilOp::decrement_wrap}},
                           .write_colour = false};
  // Draws where exactly one volume was entered and not left.
  const RasterState shadow_{.depth = {.test = false},
                            .stencil = StencilState{.front = {.compare = Compare::equal, .reference = 1},
                                                    .back = {.compare = Compare::never}}};
  std::array<Rectangle, 8> rectangles_{{
      {0, 0, 8, 8, kFloor},
      {2, 1, 6, 8, kBefore},            // a volume that the floor cuts
      {2, 1, 6, 8, kBehind, {}, false}, //
      {4, 1, 8, 8, kBefore},            // a volume before the floor
      {4, 1, 8, 8, 0.375f, {}, false},  //
      {0, 0, 8, 1, kBefore, {}, false}, // back faces alone: a count below zero wraps
      {0, 0, 4, 1, kBefore},            // and wraps back
      {0, 0, 8, 8, kBefore, {5, 6, 7, 8}},
  }};
  std::uint8_t counted(std::uint32_t pixel) const {
    int count = 0;
    for (std::size_t i = 1; i < 7; ++i)
      if (rectangles_[i].covers(pixel) && rectangles_[i].depth < kFloor) count += rectangles_[i].front ? 1 : -1;
    return static_cast<std::uint8_t>(count);
  }
};

TEST_F(StencilTest, VolumesAreCounted) {
  place(rectangles_);
  RasterTarget target(device(), kSize, kSize, attachments_);
  const RasterPipeline floor = pipeline(kColoured, attachments_, kLess);
  const RasterPipeline count = pipeline(kDepthOnly, attachments_, count_);
  const RasterPipeline shadow = pipeline(kColoured, attachments_, shadow_);
  const VertexRange ranges[3] = {range(0), range(1, 6), range(7)};
  const RasterDraw first[2] = {draw(floor, ranges[0]), draw(count, ranges[1])};
  const RasterDraw second[2] = {draw(count, ranges[1]), draw(shadow, ranges[2])};
  Commands commands(device());
  target.draw(commands, {.draws = first});
  target.draw(commands, {.draws = second, .clear = kClearStencil}); // another light: the floor's depth stays
  target.finish(commands);
  commands.submit_and_wait();

  const auto counts = read<std::uint8_t>(target.image(2), Aspect::stencil);
  const auto depths = read<float>(target.image(2));
  const auto numbers = read<std::uint32_t>(target.image(1));
  const auto colours = read<Colour>(target.image(0));
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    EXPECT_EQ(counts[pixel], counted(pixel)) << pixel;
    EXPECT_EQ(depths[pixel], kFloor) << pixel;
    EXPECT_EQ(numbers[pixel], counted(pixel) == 1 ? 7u : 0u) << pixel;
    EXPECT_EQ(colours[pixel], counted(pixel) == 1 ? rectangles_[7].colour : rectangles_[0].colour) << pixel;
  }
  EXPECT_EQ(counts[kSize - 1], 255) << "wrapped";
  EXPECT_EQ(counts[0], 0) << "wrapped back";
  EXPECT_EQ(counts[kPixels - kSize + 2], 1);
}

// The other operations, on a stencil of 3: what a test that fails, a depth test that fails and a pass do to it.
TEST_F(StencilTest, OperationsFollowTheTests) {
  std::array<AttachmentInfo, 3> attachments = attachments_;
  attachments[2].clear = {.depth = 0.5f, .stencil = 3};
  const std::array<Rectangle, 2> rectangles{{{0, 0, 4, 8, kBefore}, {4, 0, 8, 8, kBehind}}};
  place(rectangles);
  const StencilFace passes{.fail = StencilOp::zero,
                           .depth_fail = StencilOp::invert,
                           .pass = StencilOp::replace,
                           .reference = 0x15,
                           .write_mask = 0x0f};
  StencilFace fails = passes;
  fails.compare = Compare::less; // 0x15 & 0x0f < 3 is false
  fails.read_mask = 0x0f;
  const VertexRange all = range(0, 2);
  for (const StencilFace& face : {passes, fails}) {
    RasterTarget target(device(), kSize, kSize, attachments);
    const RasterPipeline pass =
        pipeline(kDepthOnly, attachments, {.depth = {.compare = Compare::less}, .stencil = StencilState{face, face}});
    const RasterDraw one = draw(pass, all);
    Commands commands(device());
    target.draw(commands, {.draws = {&one, 1}});
    commands.submit_and_wait();
    const auto values = read<std::uint8_t>(target.image(2), Aspect::stencil);
    const bool passing = face.compare == Compare::always;
    EXPECT_EQ(values[0], passing ? 5 : 0);            // 0x15 under the mask
    EXPECT_EQ(values[kSize - 1], passing ? 0x0c : 0); // ~3 under the mask
  }
}

} // namespace
} // namespace wavepath::test
