// The images of a converted scene: files that glTF can carry as they are, and those that are made anew as PNG.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <glm/glm.hpp>

namespace wavepath::convert {

inline constexpr std::uint32_t kNoImage = 0xffffffffu;

// The content of an image: colours, which are encoded as sRGB, or numbers.
enum class Holds : std::uint8_t { colors, numbers };

// Pixels: linear colours and alpha, rows from the top.
struct Pixels {
  std::uint32_t width = 0, height = 0;
  std::vector<glm::vec4> values;

  // Of the pixel that a texture coordinate falls on, in a picture that repeats.
  const glm::vec4& at(double u, double v) const;
};

struct Image {
  std::string name;
  std::string mime;                // of `bytes`
  std::vector<std::uint8_t> bytes; // a file, as glTF carries it
  Holds holds = Holds::colors;
  double scale = 1.0; // of the values, above 1 where the file had such
};

class Images {
public:
  // A file of any format that the program reads. Throws Error. The same file is read once.
  std::uint32_t add_file(const std::string& path, Holds holds);
  // Values outside 0..1 are cut.
  std::uint32_t add(const std::string& name, const Pixels& pixels, Holds holds);
  // Values of an image as they mean: of colours linear, times its scale.
  const Pixels& pixels(std::uint32_t image);

  const std::vector<Image>& all() const { return images_; }

private:
  std::vector<Image> images_;
  std::map<std::pair<std::string, Holds>, std::uint32_t> files_;
  std::map<std::uint32_t, Pixels> pixels_;
};

} // namespace wavepath::convert
