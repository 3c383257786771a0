// EXR files under other programs' names of layers, in parts and by every compression: OpenImageIO and, where it is
// installed, Blender see what was written; wavepath reads all of them under its own names.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <gtest/gtest.h>

#include "host/film/film.h"
#include "host/picture/files/layers.h"
#include "host/picture/files/picture_io.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

const std::vector<std::string> kChannels = {
    "R",          "G",           "B",           "A",           "albedo.R",   "albedo.G",   "albedo.B",   "N.X",
    "N.Y",        "N.Z",         "Z",           "P.X",         "P.Y",        "P.Z",        "variance.R", "variance.G",
    "variance.B", "samples",     "direct.R",    "direct.G",    "direct.B",   "emission.R", "emission.G", "emission.B",
    "roughness",  "id.triangle", "id.instance", "id.material", "denoised.R", "denoised.G", "denoised.B"};

Picture example(std::uint32_t width = 37, std::uint32_t height = 21) {
  Picture picture{width, height, {}};
  std::mt19937 random(5);
  std::exponential_distribution<float> radiance(1.0f);
  for (const std::string& name : kChannels) {
    Channel& channel = picture.channels.emplace_back(Channel{name, {}});
    for (std::uint32_t i = 0; i < width * height; ++i) channel.values.push_back(radiance(random));
  }
  return picture;
}

// Sums that are no sums of anything.
std::shared_ptr<const Film> example_film(std::uint32_t width = 37, std::uint32_t height = 21) {
  Film film = make_film({.width = width, .height = height, .aovs = true});
  std::mt19937 random(6);
  const auto fill = [&](auto& values) {
    std::vector<std::uint32_t> words(values.size() * sizeof(values[0]) / 4);
    for (std::uint32_t& word : words) word = static_cast<std::uint32_t>(random());
    std::memcpy(static_cast<void*>(values.data()), words.data(), 4 * words.size());
  };
  fill(film.pixels);
  fill(film.aovs);
  return std::make_shared<Film>(std::move(film));
}

PictureInfo example_info() {
  PictureInfo info;
  info.spp = 4;
  info.view = View{false, {1.0, 2.0, 3.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, -0.8}, {0.0, 0.5, 0.0}};
  info.focus = 2.5;
  info.exposure_seconds = 0.02;
  info.frame = SequenceFrame{3 * 24 + 5, 24.0};
  return info;
}

// A part of a file, as OpenImageIO reads it.
struct Part {
  OIIO::ImageSpec spec;
  std::vector<float> values; // channels interleaved

  std::vector<float> channel(const std::string& name) const {
    const auto found = std::ranges::find(spec.channelnames, name);
    if (found == spec.channelnames.end()) return {};
    std::vector<float> plane;
    for (std::size_t i = static_cast<std::size_t>(found - spec.channelnames.begin()); i < values.size();
         i += spec.channelnames.size())
      plane.push_back(values[i]);
    return plane;
  }
  std::string name() const { return spec.get_string_attribute("oiio:subimagename"); }
};

std::vector<Part> read_parts(const std::string& path) {
  std::vector<Part> parts;
  const auto input = OIIO::ImageInput::open(path);
  EXPECT_NE(input, nullptr) << OIIO::geterror();
  for (int i = 0; input && input->seek_subimage(i, 0); ++i) {
    Part& part = parts.emplace_back(Part{input->spec(i), {}});
    part.values.resize(static_cast<std::size_t>(part.spec.width * part.spec.height * part.spec.nchannels));
    EXPECT_TRUE(input->read_image(i, 0, 0, part.spec.nchannels, OIIO::TypeDesc::FLOAT, part.values.data()))
        << input->geterror();
  }
  return parts;
}

class PictureLayers : public ::testing::Test {
protected:
  std::string write(const Picture& picture, const WriteOptions& options, const PictureInfo& info = example_info()) {
    const std::string path = folder_.file("picture.exr");
    write_picture(path, picture, info, options);
    return path;
  }
  TemporaryFolder folder_;
};

TEST(LayerNames, AreThoseOfBlender) {
  const std::map<std::string, std::string> expected = {
      {"R", "ViewLayer.Combined.R"},
      {"A", "ViewLayer.Combined.A"},
      {"Z", "ViewLayer.Depth.Z"},
      {"N.X", "ViewLayer.Normal.X"},
      {"P.Y", "ViewLayer.Position.Y"},
      {"albedo.G", "ViewLayer.Denoising Albedo.G"},
      {"emission.B", "ViewLayer.Emit.B"},
      {"uv.U", "ViewLayer.UV.U"},
      {"samples", "ViewLayer.Debug Sample Count.X"},
      {"id.material", "ViewLayer.IndexMA.X"},
      {"id.triangle", "ViewLayer.id triangle.X"},
      {"roughness", "ViewLayer.roughness.X"},
      {"direct.R", "ViewLayer.direct.R"},
      {"CryptoObject00.R", "CryptoObject00.R"}, // as its header says
  };
  for (const auto& [ours, blender] : expected) {
    EXPECT_EQ(written_name(LayerNames::blender, ours), blender);
    EXPECT_EQ(written_name(LayerNames::plain, ours), ours);
  }
}

// Every layout: our own reader gives our names and all bits, sums included.
TEST_F(PictureLayers, AllLosslessLayoutsReadBackBitByBit) {
  const Picture picture = example();
  PictureInfo info = example_info();
  info.film = example_film();
  for (std::size_t compression = 0; compression < std::size(kCompressionNames); ++compression)
    for (const LayerNames layers : {LayerNames::plain, LayerNames::blender})
      for (const bool multi_part : {false, true}) {
        SCOPED_TRACE(std::string(kCompressionNames[compression]) + (multi_part ? ", parts" : ""));
        const auto by = static_cast<Compression>(compression);
        const std::string path = write(picture, {.layers = layers, .compression = by, .multi_part = multi_part}, info);
        const Picture back = read_picture(path);
        ASSERT_EQ(back.channels.size(), picture.channels.size());
        for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(back.channels[i].name, std::string(1, "RGBA"[i]));
        for (const Channel& channel : picture.channels) {
          const Channel* read = find_channel(back, channel.name);
          ASSERT_NE(read, nullptr) << channel.name;
          if (by == Compression::dwaa && is_colour(channel.name)) continue;
          EXPECT_EQ(read->values, channel.values) << channel.name;
        }
        EXPECT_TRUE(*read_film(path) == *info.film);
        EXPECT_EQ(read_attribute(path, "wavepath.version"), WAVEPATH_VERSION);
        EXPECT_EQ(is_lossy(path), by == Compression::dwaa);
        EXPECT_EQ(read_frame(path)->number, 77);
        EXPECT_EQ(read_frame(path)->per_second, 24.0);
      }
}

TEST_F(PictureLayers, OpenImageIoSeesBlendersNames) {
  const Picture picture = example();
  const std::vector<Part> parts = read_parts(write(picture, {.layers = LayerNames::blender}));
  ASSERT_EQ(parts.size(), 1u);
  const OIIO::ImageSpec& spec = parts[0].spec;
  EXPECT_EQ(spec.channelnames.size(), picture.channels.size());
  for (const Channel& channel : picture.channels)
    EXPECT_EQ(parts[0].channel(written_name(LayerNames::blender, channel.name)), channel.values) << channel.name;
  EXPECT_EQ(spec.get_float_attribute("focus"), 2.5f);
  EXPECT_EQ(spec.get_float_attribute("ExposureTime"), 0.02f); // OpenEXR's expTime
  EXPECT_EQ(spec.get_int_attribute("imageCounter"), 77);
  const auto* rate = spec.find_attribute("FramesPerSecond", OIIO::TypeDesc::UNKNOWN, false);
  ASSERT_NE(rate, nullptr);
  EXPECT_EQ(static_cast<const int*>(rate->data())[0], 24 * static_cast<const int*>(rate->data())[1]);
  const auto* code = spec.find_attribute("smpte:TimeCode", OIIO::TypeDesc::UNKNOWN, false);
  ASSERT_NE(code, nullptr);
  EXPECT_EQ(static_cast<const std::uint32_t*>(code->data())[0], 0x305u); // 3 seconds and 5 frames, a digit in 4 bits
  const auto* chromaticities = spec.find_attribute("chromaticities");
  ASSERT_NE(chromaticities, nullptr);
  EXPECT_FLOAT_EQ(static_cast<const float*>(chromaticities->data())[0], 0.64f); // red of Rec. 709
  EXPECT_NE(spec.find_attribute("worldtocamera", OIIO::TypeDesc::TypeMatrix), nullptr);
  EXPECT_NE(spec.find_attribute("worldtoNDC", OIIO::TypeDesc::UNKNOWN, false), nullptr);
}

TEST_F(PictureLayers, OpenImageIoSeesAPartForEachLayer) {
  const Picture picture = example();
  const std::vector<Part> parts = read_parts(write(picture, {.multi_part = true}));
  std::vector<std::string> names;
  for (const Part& part : parts) names.push_back(part.name());
  const std::vector<std::string> expected = {"rgba",    "albedo", "N",        "depth",     "P",  "variance",
                                             "samples", "direct", "emission", "roughness", "id", "denoised"};
  EXPECT_EQ(names, expected);
  std::size_t channels = 0;
  for (const Part& part : parts) {
    channels += part.spec.channelnames.size();
    EXPECT_NE(part.spec.find_attribute("chromaticities"), nullptr) << part.name();
    for (const std::string& name : part.spec.channelnames) {
      const Channel* channel = find_channel(picture, name);
      ASSERT_NE(channel, nullptr) << name;
      EXPECT_EQ(part.channel(name), channel->values) << name;
    }
  }
  EXPECT_EQ(channels, picture.channels.size());
}

// dwaa takes every channel whose name ends in R, G, B or Y for a colour: it would ruin normals, positions and ids.
TEST_F(PictureLayers, LossIsOfColoursAlone) {
  Picture picture = example(64, 64);
  for (Channel& channel : picture.channels) // smooth, as the compression expects it
    for (std::size_t i = 0; i < channel.values.size(); ++i)
      channel.values[i] = 0.3f + 0.2f * std::sin(0.1f * static_cast<float>(i % 64)) + 1e-5f * channel.values[i];
  const std::vector<Part> parts = read_parts(write(picture, {.compression = Compression::dwaa}));
  ASSERT_EQ(parts.size(), 2u);
  EXPECT_EQ(parts[0].name(), "colours");
  EXPECT_EQ(parts[1].name(), "data");
  EXPECT_EQ(parts[0].spec.get_string_attribute("compression").substr(0, 4), "dwaa");
  EXPECT_EQ(parts[1].spec.get_string_attribute("compression"), "zip");
  bool loses = false;
  for (const Channel& channel : picture.channels) {
    const Part& part = parts[is_colour(channel.name) ? 0 : 1];
    const std::vector<float> values = part.channel(channel.name);
    ASSERT_EQ(values.size(), channel.values.size()) << channel.name;
    if (!is_colour(channel.name)) {
      EXPECT_EQ(values, channel.values) << channel.name;
    }
    loses = loses || values != channel.values;
    for (std::size_t i = 0; i < values.size(); ++i) ASSERT_NEAR(values[i], channel.values[i], 0.01f) << channel.name;
  }
  EXPECT_TRUE(loses);

  picture.channels.resize(4);
  EXPECT_EQ(read_parts(write(picture, {.compression = Compression::dwaa})).size(), 1u) << "there is no data";
}

TEST_F(PictureLayers, PngHoldsSixteenBits) {
  Picture picture = example();
  picture.channels.resize(4); // else the filtered ones are shown
  for (std::size_t i = 0; i < picture.channels[0].values.size(); ++i)
    picture.channels[0].values[i] = static_cast<float>(i) / 776.0f;
  std::ranges::fill(picture.channels[3].values, 1.0f); // opaque
  const std::string path = folder_.file("deep.png");
  write_picture(path, picture, {}, {.tonemap = Tonemap::none, .bits = 16});
  const auto input = OIIO::ImageInput::open(path);
  ASSERT_NE(input, nullptr);
  EXPECT_EQ(input->spec().format, OIIO::TypeDesc::UINT16);
  std::vector<std::uint16_t> words(std::size_t{37} * 21 * 3);
  ASSERT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT16, words.data()));
  for (std::size_t i = 0; i < words.size() / 3; ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      const float shown = to_srgb(std::clamp(picture.channels[c].values[i], 0.0f, 1.0f));
      ASSERT_EQ(words[3 * i + c], std::lround(65535.0f * shown)) << i;
    }
  EXPECT_NEAR(read_picture(path).channels[0].values[388], 0.5f, 1e-5f);
}

// Blender's compositor finds the passes by their names and writes them out again.
TEST_F(PictureLayers, BlenderOpensThem) {
  if (std::system("command -v blender > /dev/null 2>&1") != 0) GTEST_SKIP() << "no blender here";
  const Picture picture = example();
  const std::string path = write(picture, {.layers = LayerNames::blender}), script = folder_.file("passes.py");
  std::ofstream(script) << R"(import bpy, sys
path, folder = sys.argv[-2:]
scene = bpy.context.scene
image = bpy.data.images.load(path)
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 37, 21, 100
scene.use_nodes = True
nodes, links = scene.node_tree.nodes, scene.node_tree.links
nodes.clear()
shown = nodes.new("CompositorNodeImage")
shown.image = image
shown.layer = "ViewLayer"
written = nodes.new("CompositorNodeOutputFile")
written.base_path = folder
written.format.file_format, written.format.color_depth = "OPEN_EXR", "32"
written.file_slots.clear()
for name in ("Combined", "Normal", "Depth", "Position", "Emit"):
    written.file_slots.new(name + "_")
    links.new(shown.outputs[name], written.inputs[-1])
links.new(shown.outputs["Combined"], nodes.new("CompositorNodeComposite").inputs[0])
bpy.ops.render.render()
)";
  const std::string command = "blender -b --factory-startup --python-exit-code 3 -P '" + script + "' -- '" + path +
                              "' '" + folder_.file("") + "' > '" + folder_.file("log") + "' 2>&1";
  ASSERT_EQ(std::system(command.c_str()), 0);
  const std::map<std::string, std::vector<std::string>> passes = {{"Combined", {"R", "G", "B"}},
                                                                  {"Normal", {"N.X", "N.Y", "N.Z"}},
                                                                  {"Depth", {"Z"}},
                                                                  {"Position", {"P.X", "P.Y", "P.Z"}},
                                                                  {"Emit", {"emission.R", "emission.G", "emission.B"}}};
  for (const auto& [pass, channels] : passes) {
    const std::vector<Part> seen = read_parts(folder_.file(pass + "_0001.exr"));
    ASSERT_EQ(seen.size(), 1u) << pass;
    for (std::size_t c = 0; c < channels.size(); ++c)
      EXPECT_EQ(seen[0].channel(std::string(1, "RGB"[c])), find_channel(picture, channels[c])->values)
          << channels[c] << " among " << fmt::format("{}", fmt::join(seen[0].spec.channelnames, " "));
  }
}

} // namespace
} // namespace wavepath::test
