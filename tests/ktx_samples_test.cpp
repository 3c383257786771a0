// KTX2 files of others: those of shared/scenes, and file by file against the PNG or JPEG picture of the same asset
// where WAVEPATH_SAMPLE_ASSETS names a folder with the Khronos sample assets.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <gtest/gtest.h>

#include "host/base/read_file.h"
#include "host/scene/gltf/image.h"
#include "tests/ktx_builder.h"

namespace wavepath::test {
namespace {

namespace fs = std::filesystem;

const fs::path kLamp = fs::path(WAVEPATH_SOURCE_DIR) / "../shared/scenes/AnisotropyBarnLamp/glTF-KTX-BasisU";

TextureImage load(const fs::path& path) {
  return decode_image("test", path.filename().string(), read_whole_file(path).value());
}

// Of unit vectors, the share that has nearly the length 1 still: a wrong block of one mode would show.
TEST(KtxSamples, NormalsAreUnitVectors) {
  if (!fs::exists(kLamp)) GTEST_SKIP() << "no shared/scenes beside the repository";
  const TextureImage normals = load(kLamp / "AnisotropyBarnLamp_normalbump.ktx2");
  EXPECT_EQ(normals.transfer, ktx::Transfer::linear);
  std::size_t near = 0;
  const std::size_t texels = normals.image.bytes.size() / 4;
  ASSERT_EQ(texels, std::size_t{2048} * 2048);
  for (std::size_t i = 0; i < texels; ++i) {
    double square = 0.0;
    for (std::size_t c = 0; c < 3; ++c) square += std::pow(normals.image.bytes[4 * i + c] / 127.5 - 1.0, 2);
    near += std::abs(std::sqrt(square) - 1.0) < 0.02;
  }
  EXPECT_GT(static_cast<double>(near) / static_cast<double>(texels), 0.99);
}

TEST(KtxSamples, ColoursAreSrgbAndOpaque) {
  if (!fs::exists(kLamp)) GTEST_SKIP() << "no shared/scenes beside the repository";
  const TextureImage color = load(kLamp / "AnisotropyBarnLamp_basecolor.ktx2");
  EXPECT_EQ(color.transfer, ktx::Transfer::srgb);
  EXPECT_FALSE(color.premultiplied);
  for (const char* name : {"anisotropy", "occlusionroughnessmetal"}) {
    const TextureImage data = load(kLamp / ("AnisotropyBarnLamp_" + std::string(name) + ".ktx2"));
    EXPECT_EQ(data.transfer, ktx::Transfer::linear);
    for (std::size_t i = 3; i < data.image.bytes.size(); i += 4) ASSERT_EQ(data.image.bytes[i], 255);
  }
}

// Decibels of the worst channel.
double psnr(const Image& a, const Image& b) {
  std::array<double, 4> squares{};
  for (std::size_t i = 0; i < a.bytes.size(); ++i) squares[i % 4] += std::pow(a.bytes[i] - b.bytes[i], 2);
  const double most = *std::max_element(squares.begin(), squares.end()) / (static_cast<double>(a.bytes.size()) / 4);
  return most > 0.0 ? 10.0 * std::log10(255.0 * 255.0 / most) : 200.0;
}

// UASTC keeps 40 dB of a picture without loss; one block of a thousand that is read wrongly leaves as much. A block of
// ETC1S has one colour and four lightnesses, and a JPEG file has a loss of its own: 28 dB, or one wrong block of fifty.
TEST(KtxSamples, EqualTheirFallback) {
  const char* folder = std::getenv("WAVEPATH_SAMPLE_ASSETS");
  if (!folder) GTEST_SKIP() << "WAVEPATH_SAMPLE_ASSETS names no folder with the Khronos sample assets";
  std::map<std::string, fs::path> plain; // by asset and name
  std::vector<fs::path> compressed;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    const fs::path& path = entry.path();
    const std::string key = path.parent_path().parent_path().filename().string() + "/" + path.stem().string();
    if (path.extension() == ".png" || (path.extension() == ".jpg" && !plain.contains(key))) plain[key] = path;
    if (path.extension() == ".ktx2") compressed.push_back(path);
  }
  int compared = 0;
  for (const fs::path& path : compressed) {
    SCOPED_TRACE(path.string());
    // Differs from its PNG in red and green, by whatever decoder: the two are probably not of one revision.
    if (path.stem() == "AnisotropyBarnLamp_anisotropy") continue;
    const TextureImage file = load(path);
    const auto found = plain.find(path.parent_path().parent_path().filename().string() + "/" + path.stem().string());
    if (found == plain.end()) continue;
    const Image other = load(found->second).image;
    if (other.width != file.image.width || other.height != file.image.height) continue; // scaled down
    const std::string payload = read_ktx(read_whole_file(path).value()).payload;
    const bool is_close = payload == "UASTC" && found->second.extension() == ".png";
    EXPECT_GT(psnr(file.image, other), is_close ? 40.0 : 28.0) << payload;
    ++compared;
  }
  EXPECT_GT(compared, 0);
}

} // namespace
} // namespace wavepath::test
