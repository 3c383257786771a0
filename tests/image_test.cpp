// Images that kernels sample: drawn, uploaded, filtered, compared with a reference, and refused.
#include <cstdint>
#include <functional>

#include "tests/probes/raster_sample.spv.h"
#include "tests/probes/raster_shadow.spv.h"
#include "tests/raster_fixture.h"

namespace wavepath::test {
namespace {

class ImageTest : public RasterTest {};

struct Sampled { // as raster_sample.comp writes it
  Colour colour;
  float depth;
  std::uint32_t word, pad[2];
};

std::string message_of(const std::function<void()>& attempt) {
  try {
    attempt();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST_F(ImageTest, KernelsSampleColourDepthAndWords) {
  place(kOverlapping);
  RasterTarget target(device(), kSize, kSize, kGbuffer);
  const RasterPipeline pass = pipeline(kColoured, kGbuffer, {});
  const VertexRange all = range(0, 3);
  const RasterDraw one = draw(pass, all);

  std::vector<std::array<float, 2>> places;
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel)
    places.push_back(
        {(static_cast<float>(pixel % kSize) + 0.5f) / kSize, (static_cast<float>(pixel / kSize) + 0.5f) / kSize});
  const Buffer places_buffer = upload(device(), places);
  const Buffer results(device(), kPixels * sizeof(Sampled));
  using enum BindingKind;
  const std::array<Binding, 5> bindings{{{.slot = 0, .buffer = &places_buffer},
                                         {.slot = 1, .kind = sampled_image, .image = &target.image(0)},
                                         {.slot = 2, .kind = sampled_image, .image = &target.image(1)},
                                         {.slot = 3, .kind = sampled_image, .image = &target.image(2)},
                                         {.slot = 4, .buffer = &results}}};
  const BindingSet set(device(), bindings, sizeof(std::uint32_t));
  const Kernel kernel(device(), {"sample", wavepath_raster_sample_spv}, set, {});
  Commands commands(device()); // drawing and sampling in one submission
  target.draw(commands, {.draws = {&one, 1}});
  target.finish(commands);
  commands.bind(set);
  commands.dispatch(kernel, groups_for(kPixels), &kPixels);
  commands.submit_and_wait();

  const auto sampled = download<Sampled>(results, kPixels);
  const auto colours = read<Colour>(target.image(0));
  const auto depths = read<float>(target.image(1));
  const auto numbers = read<std::uint32_t>(target.image(2));
  EXPECT_EQ(numbers[0], 0u);
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    EXPECT_EQ(sampled[pixel].colour, colours[pixel]) << pixel;
    EXPECT_EQ(sampled[pixel].depth, depths[pixel]) << pixel;
    EXPECT_EQ(sampled[pixel].word, numbers[pixel]) << pixel;
  }
}

// A depth image of two layers without fragment shader, as a shadow map is drawn, compared as one is read.
TEST_F(ImageTest, ShadowMapsOfSeveralLayers) {
  const std::array<AttachmentInfo, 1> attachments{
      {{.name = "shadow map", .format = ImageFormat::depth32f, .sampled = true, .clear = {.depth = 1.0f}}}};
  const std::array<Rectangle, 2> rectangles{{{0, 0, 4, 8, 0.25f}, {4, 0, 8, 8, 0.5f}}};
  place(rectangles);
  RasterTarget target(device(), kSize, kSize, attachments, 2);
  const RasterPipeline pass = pipeline(kDepthOnly, attachments, kLess);
  const VertexRange left = range(0), right = range(1);
  const RasterDraw draws[2] = {draw(pass, left), draw(pass, right)};
  Commands commands(device());
  target.draw(commands, {.draws = {&draws[0], 1}, .layer = 0});
  target.draw(commands, {.draws = {&draws[1], 1}, .layer = 1});
  target.finish(commands);
  commands.submit_and_wait();

  // u, v, layer, reference; lit where reference <= depth, and outside of the map.
  const std::vector<Colour> places{{0.25f, 0.5f, 0, 0.25f}, {0.25f, 0.5f, 0, 0.26f},  {0.75f, 0.5f, 0, 0.26f},
                                   {0.25f, 0.5f, 1, 0.6f},  {0.75f, 0.5f, 1, 0.6f},   {0.5f, 0.5f, 1, 0.6f},
                                   {0.5f, 0.5f, 0, 0.3f},   {-0.75f, 0.5f, 0, 0.99f}, {0.5f, 0.5f, 0, 0.2f}};
  const Buffer places_buffer = upload(device(), places);
  const std::vector<float> linear{1, 0, 1, 1, 0, 0.5f, 0.5f, 1, 1};
  for (const Filter filter : {Filter::nearest, Filter::linear}) {
    Buffer results(device(), places.size() * sizeof(float));
    const Sampling sampling{.filter = filter, .address = Address::border_one, .compare = Compare::less_or_equal};
    const std::array<Binding, 3> bindings{
        {{.slot = 0, .buffer = &places_buffer},
         {.slot = 1, .kind = BindingKind::sampled_image, .image = &target.image(0), .sampling = sampling},
         {.slot = 2, .buffer = &results}}};
    const auto count = static_cast<std::uint32_t>(places.size());
    const std::string refusal = message_of([&] { run({"shadow", wavepath_raster_shadow_spv}, bindings, count); });
    if (filter == Filter::linear && !refusal.empty()) { // llvmpipe filters no depths
      EXPECT_NE(refusal.find("cannot linearly filter depth32f images"), std::string::npos) << refusal;
      continue;
    }
    EXPECT_EQ(refusal, "");
    const auto lit = download<float>(results, places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      if (linear[i] != 0.5f || filter == Filter::linear) {
        EXPECT_EQ(lit[i], linear[i]) << i;
      }
  }

  const auto depths = read<float>(target.image(0)); // layer by layer
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
    EXPECT_EQ(depths[pixel], rectangles[0].covers(pixel) ? 0.25f : 1.0f) << pixel;
    EXPECT_EQ(depths[kPixels + pixel], rectangles[1].covers(pixel) ? 0.5f : 1.0f) << pixel;
  }
}

// Uploaded images: linear filtering half-way between two texels, repetition and borders, and a stencil as words.
TEST_F(ImageTest, ImagesAreUploadedAndFiltered) {
  DeviceImage colour(device(), {.format = ImageFormat::rgba16f, .width = 2, .height = 1, .sampled = true});
  DeviceImage depth(device(), {.format = ImageFormat::depth32f, .width = 2, .height = 1, .sampled = true});
  DeviceImage stencil(device(), {.format = ImageFormat::depth32f_stencil8, .width = 2, .height = 1, .sampled = true});
  // Halfs: 1, 2, 3, 4 and 2, 4, 6, 8.
  const Buffer halfs = upload(device(), std::vector<std::uint16_t>{0x3c00, 0x4000, 0x4200, 0x4400, //
                                                                   0x4000, 0x4400, 0x4600, 0x4800});
  const Buffer floats = upload(device(), std::vector<float>{0.25f, 0.75f});
  const Buffer bytes = upload(device(), std::vector<std::uint8_t>{17, 200, 0, 0});
  {
    Commands commands(device());
    colour.copy_from(commands.handle(), halfs);
    depth.copy_from(commands.handle(), floats);
    stencil.copy_from(commands.handle(), floats);
    stencil.copy_from(commands.handle(), bytes, Aspect::stencil);
    for (DeviceImage* image : {&colour, &depth, &stencil}) image->transition(commands.handle(), ImageUse::sampled);
    commands.submit_and_wait();
  }
  const std::vector<std::array<float, 2>> places{{0.5f, 0.5f}, {0.25f, 0.5f}, {0.75f, 0.5f}, {1.25f, 0.5f}};
  const Buffer places_buffer = upload(device(), places);
  const Buffer results(device(), places.size() * sizeof(Sampled));
  using enum BindingKind;
  const std::array<Binding, 5> bindings{
      {{.slot = 0, .buffer = &places_buffer},
       {.slot = 1,
        .kind = sampled_image,
        .image = &colour,
        .sampling = {.filter = Filter::linear, .address = Address::repeat}},
       {.slot = 2, .kind = sampled_image, .image = &depth, .sampling = {.address = Address::border_zero}},
       {.slot = 3, .kind = sampled_image, .image = &stencil, .aspect = Aspect::stencil},
       {.slot = 4, .buffer = &results}}};
  run({"sample", wavepath_raster_sample_spv}, bindings, static_cast<std::uint32_t>(places.size()));
  const auto sampled = download<Sampled>(results, places.size());
  EXPECT_EQ(sampled[0].colour, (Colour{1.5f, 3.0f, 4.5f, 6.0f}));
  EXPECT_EQ(sampled[1].colour, (Colour{1, 2, 3, 4}));
  EXPECT_EQ(sampled[2].colour, (Colour{2, 4, 6, 8}));
  EXPECT_EQ(sampled[3].colour, (Colour{1, 2, 3, 4})) << "repeated";
  EXPECT_EQ(sampled[1].depth, 0.25f);
  EXPECT_EQ(sampled[2].depth, 0.75f);
  EXPECT_EQ(sampled[3].depth, 0.0f) << "border";
  EXPECT_EQ(sampled[1].word, 17u);
  EXPECT_EQ(sampled[2].word, 200u);
  EXPECT_EQ(sampled[3].word, 200u) << "clamped";
  EXPECT_EQ(read<float>(stencil), (std::vector<float>{0.25f, 0.75f}));
  EXPECT_EQ(read<std::uint8_t>(stencil, Aspect::stencil), (std::vector<std::uint8_t>{17, 200}));
}

TEST_F(ImageTest, WhatADeviceLacksIsRefusedByName) {
  const DeviceImage words(device(), {.format = ImageFormat::r32ui, .width = 4, .height = 4, .sampled = true});
  const auto bind = [&](const Sampling& sampling) {
    const Binding binding{.kind = BindingKind::sampled_image, .image = &words, .sampling = sampling};
    const BindingSet set(device(), {&binding, 1}, 0);
  };
  EXPECT_NE(message_of([&] { bind({.filter = Filter::linear}); }).find("cannot linearly filter r32ui"),
            std::string::npos);
  EXPECT_NE(message_of([&] { bind({.compare = Compare::less}); }).find("cannot compare depths of r32ui"),
            std::string::npos);
  const std::string size = message_of([&] {
    const DeviceImage image(device(), {.name = "wide", .format = ImageFormat::rgba32f, .width = 1u << 30, .height = 1});
  });
  EXPECT_NE(size.find("rgba32f images of at most"), std::string::npos) << size;
  EXPECT_NE(size.find("1073741824x1"), std::string::npos) << size;
  EXPECT_NE(size.find("wide"), std::string::npos) << size;
  const std::vector<AttachmentInfo> many(1000, kGbuffer[0]);
  const std::string count = message_of([&] { const RasterTarget target(device(), 4, 4, many); });
  EXPECT_NE(count.find("images at once, not 1000"), std::string::npos) << count;
  const std::string pixels = message_of([&] { const RasterTarget target(device(), 1u << 30, 4, std::span(kGbuffer)); });
  EXPECT_NE(pixels.find("rasterizes at most"), std::string::npos) << pixels;
}

} // namespace
} // namespace wavepath::test
