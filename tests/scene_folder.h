// A folder of files that a command might overwrite, and what tells that it did not.
#pragma once

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/picture/files/picture_io.h"
#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {

inline std::string contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline Picture grey(std::uint32_t width, std::uint32_t height) {
  Picture picture{width, height, {}};
  for (const char* name : {"R", "G", "B"})
    picture.channels.push_back({name, std::vector<float>(std::size_t{width} * height, 0.5f)});
  return picture;
}

// A folder with a scene of several files, an environment, a reference and pictures to compare.
class SceneFolder : public ::testing::Test {
protected:
  SceneFolder() {
    write_picture(file("skin.png"), grey(2, 2), {}, {});
    for (const char* name : {"sky.exr", "reference.exr", "other.exr", "unused.png"})
      write_picture(file(name), grey(8, 4), {}, {});
    std::ofstream(file("shape.bin"), std::ios::binary) << std::string(36 + 24, '\0');
    // A triangle of no size: what is loaded is never rendered here.
    std::ofstream(file("scene.gltf")) << R"({"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}], "scene": 0,
      "nodes": [{"mesh": 0}],
      "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
      "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
      "textures": [{"source": 0}], "images": [{"uri": "skin.png"}, {"uri": "unused.png"}],
      "buffers": [{"uri": "shape.bin", "byteLength": 60}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3",
                     "min": [0, 0, 0], "max": [0, 0, 0]},
                    {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}]})";
    std::filesystem::create_directory(file("sub"));
    std::filesystem::create_symlink("sky.exr", file("soft.exr"));
    std::filesystem::create_symlink("made-later.exr", file("dangling.exr"));
    std::filesystem::create_directory_symlink("sub", file("way"));
    std::filesystem::create_hard_link(file("skin.png"), file("hard.png"));
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path()))
      if (entry.is_regular_file()) before_[entry.path()] = contents(entry.path());
  }

  std::string file(const std::string& name) const { return folder_.file(name); }

  // In the folder.
  Outcome run(std::vector<std::string> words, RunOptions options = {}) const {
    words.insert(words.begin(), WAVEPATH_BINARY);
    options.folder = folder_.path().string();
    return run_program(words, options);
  }

  // Exit code 2, one line, and every file as it was.
  void expect_refused(const std::string& line, const std::string& words) const {
    SCOPED_TRACE(line);
    std::istringstream stream(line);
    std::vector<std::string> arguments{std::istream_iterator<std::string>(stream), {}};
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    EXPECT_NE(outcome.err.find(words), std::string::npos) << outcome.err;
    EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
    for (const auto& [path, bytes] : before_) EXPECT_EQ(contents(path), bytes) << path;
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) count += entry.is_regular_file();
    EXPECT_EQ(count, before_.size());
  }

  TemporaryFolder folder_;
  std::map<std::filesystem::path, std::string> before_;
};

} // namespace wavepath::test
