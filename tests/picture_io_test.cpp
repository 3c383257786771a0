// Pictures written and read back: EXR with its header, display formats, and failure without incomplete files.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <random>

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMatrixAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <sys/resource.h>

#include <gtest/gtest.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/codecs/linear_picture.h"
#include "host/codecs/png.h"
#include "host/picture/files/exr.h"
#include "host/picture/files/picture_io.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {
namespace {

Picture random_picture(std::uint32_t width, std::uint32_t height, const std::vector<std::string>& names) {
  Picture picture{width, height, {}};
  std::mt19937 random(7);
  std::exponential_distribution<float> radiance(1.0f);
  for (const std::string& name : names) {
    Channel& channel = picture.channels.emplace_back(Channel{name, {}});
    for (std::uint32_t i = 0; i < width * height; ++i) channel.values.push_back(radiance(random));
  }
  return picture;
}

PictureInfo example_info() {
  PictureInfo info;
  info.spp = 64;
  info.seconds = 1.5;
  info.error = 0.25;
  info.seed = 9;
  info.samples = "0:64";
  info.scene = "box.gltf";
  info.command = "wavepath render box.gltf";
  info.filter = "box";
  info.bias = "light paths end after 8 bounces (--max-depth)";
  // At (1,2,3), looking along -X with +Y up: right is forward x up = -Z.
  info.view = View{false, {1.0, 2.0, 3.0}, {-1.0, 0.0, 0.0}, {0.0, 0.0, -0.8}, {0.0, 0.5, 0.0}};
  return info;
}

template <class Attribute>
auto attribute(const Imf::InputFile& file, const char* name) {
  return file.header().typedAttribute<Attribute>(name).value();
}

Imath::V3f project(const Imf::InputFile& file, const char* matrix, Imath::V3f point) {
  Imath::V3f result;
  attribute<Imf::M44fAttribute>(file, matrix).multVecMatrix(point, result);
  return result;
}

// While it lives, files of this process cannot grow beyond `bytes`.
class FileSizeLimit {
public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(FileSizeLimit&&) = delete;

private:
  rlimit before_{};
  void (*handler_)(int);
};

class PictureIoTest : public ::testing::Test {
protected:
  TemporaryFolder folder_;
};

TEST_F(PictureIoTest, ExrHasTheDocumentedHeader) {
  const std::vector<std::string> names = {"R",        "G",   "B",   "A",   "albedo.R", "albedo.G",
                                          "albedo.B", "N.X", "N.Y", "N.Z", "Z",        "samples"};
  const std::string path = folder_.file("a.exr");
  EXPECT_EQ(write_picture(path, random_picture(7, 5, names), example_info(), {}), 0u);

  const Imf::InputFile file(path.c_str());
  EXPECT_EQ(file.header().compression(), Imf::ZIP_COMPRESSION);
  EXPECT_EQ(file.header().dataWindow(), Imath::Box2i({0, 0}, {6, 4}));
  std::size_t count = 0;
  for (auto channel = file.header().channels().begin(); channel != file.header().channels().end(); ++channel, ++count)
    EXPECT_EQ(channel.channel().type, Imf::FLOAT) << channel.name();
  EXPECT_EQ(count, names.size());
  for (const std::string& name : names) EXPECT_NE(file.header().channels().findChannel(name), nullptr) << name;

  EXPECT_EQ(attribute<Imf::IntAttribute>(file, "wavepath.spp"), 64);
  EXPECT_EQ(attribute<Imf::FloatAttribute>(file, "wavepath.seconds"), 1.5f);
  EXPECT_EQ(attribute<Imf::FloatAttribute>(file, "wavepath.error"), 0.25f);
  EXPECT_EQ(attribute<Imf::IntAttribute>(file, "wavepath.seed"), 9);
  EXPECT_EQ(attribute<Imf::StringAttribute>(file, "wavepath.samples"), "0:64");
  EXPECT_EQ(attribute<Imf::StringAttribute>(file, "wavepath.scene"), "box.gltf");
  EXPECT_EQ(attribute<Imf::StringAttribute>(file, "wavepath.command"), "wavepath render box.gltf");
  EXPECT_EQ(attribute<Imf::StringAttribute>(file, "wavepath.bias"), example_info().bias);
  EXPECT_FALSE(attribute<Imf::StringAttribute>(file, "wavepath.version").empty());
  EXPECT_EQ(attribute<Imf::IntAttribute>(file, "samplesPerPixel"), 64);
  EXPECT_EQ(attribute<Imf::FloatAttribute>(file, "renderTimeSeconds"), 1.5f);
  ASSERT_TRUE(Imf::hasChromaticities(file.header())); // of Rec. 709, which is OpenEXR's default as well
  EXPECT_EQ(Imf::chromaticities(file.header()), Imf::Chromaticities());
  EXPECT_EQ(read_attribute(path, "wavepath.filter"), "box");
  EXPECT_EQ(read_attribute(path, "nothing"), "");
}

// The point is 2 ahead, 0.4 to the right (of 0.8 * 2) and 0.5 up (of 0.5 * 2).
TEST_F(PictureIoTest, ExrMatricesProject) {
  const std::string path = folder_.file("a.exr");
  write_picture(path, random_picture(2, 2, {"R", "G", "B", "A"}), example_info(), {});
  const Imf::InputFile file(path.c_str());
  const Imath::V3f point(-1.0f, 2.5f, 2.6f);
  EXPECT_TRUE(project(file, "worldToCamera", point).equalWithAbsError({0.4f, 0.5f, 2.0f}, 1e-6f));
  const Imath::V3f ndc = project(file, "worldToNDC", point);
  EXPECT_NEAR(ndc.x, 0.5f + 0.5f * 0.25f, 1e-6f);
  EXPECT_NEAR(ndc.y, 0.5f - 0.5f * 0.5f, 1e-6f); // downwards

  PictureInfo shifted = example_info();
  shifted.view->shift = {0.5, -0.25}; // of half the picture, so that all moves the other way
  write_picture(path, random_picture(2, 2, {"R", "G", "B", "A"}), shifted, {});
  const Imath::V3f moved = project(Imf::InputFile(path.c_str()), "worldToNDC", point);
  EXPECT_NEAR(moved.x, ndc.x - 0.25f, 1e-6f);
  EXPECT_NEAR(moved.y, ndc.y - 0.125f, 1e-6f);

  PictureInfo fisheye = example_info();
  fisheye.view->panorama = Panorama::fisheye;
  write_picture(path, random_picture(2, 2, {"R", "G", "B", "A"}), fisheye, {});
  const Imf::InputFile bent(path.c_str());
  EXPECT_NE(bent.header().find("worldToCamera"), bent.header().end());
  EXPECT_EQ(bent.header().find("worldToNDC"), bent.header().end());

  PictureInfo orthographic = example_info();
  orthographic.view->orthographic = true;
  write_picture(path, random_picture(2, 2, {"R", "G", "B", "A"}), orthographic, {});
  const Imath::V3f flat = project(Imf::InputFile(path.c_str()), "worldToNDC", point);
  EXPECT_NEAR(flat.x, 0.5f + 0.5f * 0.5f, 1e-6f);
  EXPECT_NEAR(flat.y, 0.5f - 0.5f * 1.0f, 1e-6f);
}

TEST_F(PictureIoTest, ExrKeepsEveryBit) {
  const Picture picture = random_picture(33, 17, {"R", "G", "B", "A", "P.X", "Z"});
  write_picture(folder_.file("a.exr"), picture, example_info(), {});
  const Picture back = read_picture(folder_.file("a.exr"));
  ASSERT_EQ(back.channels.size(), 6u);
  EXPECT_EQ(back.channels[0].name, "R");
  EXPECT_EQ(back.channels[3].name, "A");
  for (const Channel& channel : picture.channels)
    EXPECT_EQ(find_channel(back, channel.name)->values, channel.values) << channel.name;
}

TEST_F(PictureIoTest, HalfClampsAndCounts) {
  Picture picture = random_picture(4, 4, {"R", "G", "B", "A", "samples", "Z", "P.X"});
  picture.channels[5].values[2] = 1e10f; // the depth of what no ray hit
  picture.channels[6].values[2] = 123456.7f;
  picture.channels[0].values[5] = 1e6f;
  picture.channels[1].values[6] = -std::numeric_limits<float>::infinity();
  picture.channels[4].values[0] = 4097.0f;
  EXPECT_EQ(write_picture(folder_.file("h.exr"), picture, example_info(), {true, 0.0, Tonemap::neutral}), 2u);
  EXPECT_EQ(Imf::InputFile(folder_.file("h.exr").c_str()).header().channels()["R"].type, Imf::HALF);
  const Picture back = read_picture(folder_.file("h.exr"));
  EXPECT_EQ(back.channels[0].values[5], 65504.0f);
  EXPECT_EQ(back.channels[1].values[6], -65504.0f);
  EXPECT_EQ(find_channel(back, "samples")->values[0], 4097.0f);           // counts are not rounded
  EXPECT_EQ(find_channel(back, "Z")->values, picture.channels[5].values); // nor are depths and places
  EXPECT_EQ(find_channel(back, "P.X")->values, picture.channels[6].values);
  EXPECT_NEAR(back.channels[2].values[3], picture.channels[2].values[3], 1e-3f * picture.channels[2].values[3]);
}

TEST_F(PictureIoTest, HdrRoundsToNearest) {
  Picture picture = random_picture(64, 64, {"R", "G", "B", "A"});
  picture.channels[0].values[0] = -1.0f;
  EXPECT_EQ(write_picture(folder_.file("a.hdr"), picture, {}, {}), 1u);
  const Picture back = read_picture(folder_.file("a.hdr"));
  EXPECT_EQ(back.channels[0].values[0], 0.0f);
  double sum = 0.0, sum_back = 0.0;
  for (std::size_t i = 1; i < 64 * 64; ++i) {
    const float brightest =
        std::max({picture.channels[0].values[i], picture.channels[1].values[i], picture.channels[2].values[i]});
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_LE(std::abs(back.channels[c].values[i] - picture.channels[c].values[i]), brightest / 256.0f);
      sum += picture.channels[c].values[i];
      sum_back += back.channels[c].values[i];
    }
  }
  EXPECT_NEAR(sum_back / sum, 1.0, 3e-4);
}

TEST_F(PictureIoTest, PngHoldsExposedSrgb) {
  Picture picture = random_picture(3, 2, {"R", "G", "B", "A"});
  for (Channel& channel : picture.channels)
    for (float& value : channel.values) value = std::min(value, 1.0f) * 0.25f;
  std::ranges::fill(picture.channels[3].values, 1.0f); // opaque
  write_picture(folder_.file("a.png"), picture, {}, {false, 2.0, Tonemap::none});
  const Picture back = read_picture(folder_.file("a.png"));
  ASSERT_EQ(back.width, 3u);
  for (std::size_t c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < 6; ++i)
      EXPECT_NEAR(to_srgb(back.channels[c].values[i]), to_srgb(4.0f * picture.channels[c].values[i]),
                  0.5f / 255.0f + 1e-5f);
}

TEST_F(PictureIoTest, JpgDecodes) {
  Picture picture = random_picture(40, 30, {"R", "G", "B", "A"});
  for (std::size_t c = 0; c < 3; ++c)
    std::fill(picture.channels[c].values.begin(), picture.channels[c].values.end(),
              0.3f + 0.2f * static_cast<float>(c));
  write_picture(folder_.file("a.jpeg"), picture, {}, {false, 0.0, Tonemap::none});
  const Picture back = read_picture(folder_.file("a.jpeg"));
  ASSERT_EQ(back.height, 30u);
  for (std::size_t c = 0; c < 3; ++c)
    EXPECT_NEAR(back.channels[c].values[77], 0.3f + 0.2f * static_cast<float>(c), 0.02f);
}

TEST_F(PictureIoTest, ExtensionsAreKnownInAnyCase) {
  EXPECT_EQ(picture_format("a/b.EXR"), PictureFormat::exr);
  EXPECT_EQ(picture_format("x.jpeg"), PictureFormat::jpg);
  EXPECT_FALSE(picture_format("exr"));
  EXPECT_FALSE(picture_format("a.tiff"));
  EXPECT_THROW(write_picture(folder_.file("a.tiff"), random_picture(1, 1, {"R", "G", "B"}), {}, {}), Error);
}

TEST_F(PictureIoTest, FilesAreKnownByTheirFirstBytes) {
  const Picture picture = random_picture(4, 4, {"R", "G", "B"});
  for (const std::string name : {"a.png", "a.jpg", "a.hdr"}) {
    write_picture(folder_.file(name), picture, {}, {});
    const Picture back = read_picture(folder_.file(name));
    std::filesystem::rename(folder_.file(name), folder_.file("renamed.png"));
    EXPECT_EQ(read_picture(folder_.file("renamed.png")).channels[1].values, back.channels[1].values) << name;
    EXPECT_EQ(back.display, name != "a.hdr"); // what FLIP asks
  }
  std::ofstream(folder_.file("a.tiff")) << "II*";
  try {
    read_picture(folder_.file("a.tiff"));
    ADD_FAILURE() << "read";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("is no picture of a format that can be read"), std::string::npos);
  }
}

// As EXR has it: in linear light.
TEST_F(PictureIoTest, ColoursCountTimesTheirAlpha) {
  const auto read = [&](const DecodedImage& image) {
    const auto file = encode_png(image);
    write_file(folder_.file("a.png"), {file.begin(), file.end()});
    return read_picture(folder_.file("a.png"));
  };
  const Picture color = read({.shape = {1, 1, 4}, .bytes = {255, 128, 0, 51}, .words = {}});
  EXPECT_FLOAT_EQ(color.channels[0].values[0], 0.2f);
  EXPECT_FLOAT_EQ(color.channels[1].values[0], 0.2f * from_srgb(128.0f / 255.0f));
  EXPECT_EQ(color.channels[2].values[0], 0.0f);
  const Picture grey = read({.shape = {1, 1, 2}, .bytes = {}, .words = {65535, 13107}});
  ASSERT_EQ(grey.channels.size(), 3u);
  for (const Channel& channel : grey.channels) EXPECT_FLOAT_EQ(channel.values[0], 0.2f);
}

TEST_F(PictureIoTest, DamagedFilesAreRefused) {
  EXPECT_THROW(read_picture(folder_.file("absent.exr")), Error);
  write_picture(folder_.file("a.exr"), random_picture(64, 64, {"R", "G", "B", "A"}), example_info(), {});
  const auto size = std::filesystem::file_size(folder_.file("a.exr"));
  for (const std::uintmax_t kept : {size / 2, std::uintmax_t{200}, std::uintmax_t{3}, std::uintmax_t{0}}) {
    std::filesystem::resize_file(folder_.file("a.exr"), kept);
    EXPECT_THROW(read_picture(folder_.file("a.exr")), Error) << kept;
  }
  std::ofstream(folder_.file("b.png")) << "no picture";
  EXPECT_THROW(read_picture(folder_.file("b.png")), Error);
  write_picture(folder_.file("grey.exr"), random_picture(2, 2, {"Y"}), example_info(), {});
  EXPECT_EQ(read_picture(folder_.file("grey.exr")).channels[2].name, "B");
  write_picture(folder_.file("depth.exr"), random_picture(2, 2, {"Z"}), example_info(), {});
  EXPECT_THROW(read_picture(folder_.file("depth.exr")), Error);
}

// OpenEXR's destructors discard exceptions; the stream must report the failure, wherever the disk fills up.
TEST_F(PictureIoTest, AFullDiskLeavesTheOldPicture) {
  for (const std::string name : {"a.exr", "a.png", "a.hdr", "a.jpg"}) {
    const std::string path = folder_.file(name);
    const Picture picture = random_picture(50, 50, {"R", "G", "B", "A"});
    write_picture(path, picture, example_info(), {});
    const auto size = std::filesystem::file_size(path);
    for (const std::uintmax_t room : {std::uintmax_t{10}, size / 2, size - 1}) {
      std::ofstream(path) << "old";
      {
        const FileSizeLimit limit(room);
        EXPECT_THROW(write_picture(path, picture, example_info(), {}), Error) << name << " with room for " << room;
      }
      EXPECT_EQ(std::filesystem::file_size(path), 3u) << name << " with room for " << room;
    }
  }
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_.path()), std::filesystem::directory_iterator()),
            4);
}

// Both ways to read a picture of ours say the same; one that another program may have changed is left to OpenImageIO.
TEST(PictureIo, OwnPicturesAreReadAsOthersAre) {
  const TemporaryFolder folder;
  const Picture picture = random_picture(7, 5, {"R", "G", "B", "A", "Z", "albedo.R"});
  for (const bool half : {false, true}) {
    write_exr(folder.file("a.exr"), picture, example_info(), {.half = half});
    const std::optional<Picture> own = read_own_exr(folder.file("a.exr"));
    ASSERT_TRUE(own);
    const LinearPicture other = read_linear(folder.file("a.exr"), {.wanted = [](const std::string&) { return true; }});
    ASSERT_EQ(own->channels.size(), other.channels.size());
    EXPECT_EQ(own->width, other.width);
    EXPECT_EQ(own->height, other.height);
    for (std::size_t i = 0; i < other.channels.size(); ++i) {
      EXPECT_EQ(own->channels[i].name, other.channels[i]);
      EXPECT_EQ(own->channels[i].values, other.planes[i]) << other.channels[i];
    }
  }
  const std::string foreign = folder.file("foreign.exr");
  Imf::Header header(7, 5);
  for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
  Imf::FrameBuffer pixels;
  for (std::size_t c = 0; c < 3; ++c)
    pixels.insert(std::string(1, "RGB"[c]),
                  Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(const_cast<float*>(picture.channels[c].values.data())),
                             sizeof(float), sizeof(float) * 7));
  const auto write_foreign = [&] {
    Imf::OutputFile output(foreign.c_str(), header);
    output.setFrameBuffer(pixels);
    output.writePixels(5);
  };
  write_foreign();
  EXPECT_FALSE(read_own_exr(foreign));
  header.insert("wavepath.version", Imf::StringAttribute("0"));
  write_foreign();
  EXPECT_TRUE(read_own_exr(foreign));
  Imf::addChromaticities(header, {{0.713f, 0.293f}, {0.165f, 0.83f}, {0.128f, 0.044f}, {0.32168f, 0.33767f}}); // AP1
  write_foreign();
  EXPECT_FALSE(read_own_exr(foreign));
  EXPECT_FALSE(read_own_exr(folder.file("absent.exr")));
}

} // namespace
} // namespace wavepath::test
