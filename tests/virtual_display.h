// An X server without a screen, input to it (xdotool's XTest events), and the pixels it shows.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <string>
#include <thread>
#include <vector>

#include <signal.h>

#include <glm/glm.hpp>

#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"

namespace wavepath::test {

inline bool installed(const std::string& program) {
  return run_program({"/bin/sh", "-c", "command -v " + program}).exit_code == 0;
}

class VirtualDisplay {
public:
  VirtualDisplay() {
    int ready[2];
    EXPECT_EQ(pipe(ready), 0);
    child_ = fork();
    if (child_ == 0) {
      const std::string descriptor = std::to_string(ready[1]), folder = folder_.path().string();
      close(ready[0]);
      const int quiet = open("/dev/null", O_WRONLY);
      dup2(quiet, STDERR_FILENO);
      execlp("Xvfb", "Xvfb", "-displayfd", descriptor.c_str(), "-screen", "0", "640x480x24", "-fbdir", folder.c_str(),
             "-nolisten", "tcp", "-noreset", static_cast<char*>(nullptr));
      _exit(99);
    }
    close(ready[1]);
    char letter = 0;
    while (read(ready[0], &letter, 1) == 1 && letter != '\n') name_ += letter;
    close(ready[0]);
    EXPECT_FALSE(name_.empty());
    name_ = ":" + name_;
  }
  ~VirtualDisplay() {
    kill(child_, SIGTERM);
    waitpid(child_, nullptr, 0);
  }
  VirtualDisplay(VirtualDisplay&&) = delete;

  const std::string& name() const { return name_; }

  Outcome xdotool(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), {"/usr/bin/env", "DISPLAY=" + name_, "xdotool"});
    return run_program(arguments);
  }

  // Of the screen's top left corner, RGB.
  std::vector<glm::u8vec3> pixels(std::uint32_t width, std::uint32_t height) const {
    std::ifstream file(folder_.file("Xvfb_screen0"), std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    // An XWD dump: words of its header are big-endian.
    const auto word = [&](std::size_t i) {
      std::uint32_t value = 0;
      for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<std::uint8_t>(bytes.at(4 * i + k));
      return value;
    };
    constexpr std::size_t kHeaderSize = 0, kBitsPerPixel = 11, kBytesPerLine = 12, kColors = 19, kColorBytes = 12;
    EXPECT_EQ(word(kBitsPerPixel), 32u);
    const std::size_t start = word(kHeaderSize) + kColorBytes * word(kColors);
    std::vector<glm::u8vec3> pixels;
    for (std::uint32_t y = 0; y < height; ++y)
      for (std::uint32_t x = 0; x < width; ++x) {
        const std::size_t at = start + std::size_t{y} * word(kBytesPerLine) + 4 * x;
        pixels.emplace_back(bytes.at(at + 2), bytes.at(at + 1), bytes.at(at)); // stored B G R
      }
    return pixels;
  }

private:
  TemporaryFolder folder_;
  pid_t child_ = -1;
  std::string name_;
};

} // namespace wavepath::test
