// Converted scenes render to the light that closed forms give, and unmirrored.
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "host/picture/files/picture_io.h"
#include "tests/gltf_builder.h"
#include "tests/run_wavepath.h"

namespace wavepath::test {
namespace {

// Converts the text, renders it by the command that was printed, and returns the picture.
Picture rendered(const TempFolder& folder, const std::string& name, const std::string& text) {
  const std::string input = folder.write(name, text).string(), scene = (folder.path() / "out.glb").string();
  const Outcome converted = run_program({WAVEPATH_BINARY, "convert", input, scene});
  EXPECT_EQ(converted.exit_code, 0) << converted.err;
  std::vector<std::string> words;
  for (std::size_t at = 0; at < converted.out.size();) {
    const std::size_t end = converted.out.find_first_of(" \n", at);
    words.push_back(converted.out.substr(at, end - at));
    at = end + 1;
  }
  EXPECT_EQ(words.at(0), "wavepath");
  words[0] = WAVEPATH_BINARY;
  words.insert(words.end(), {"--spp", "64", "-q"});
  const Outcome outcome = run_program(words);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  return read_picture((folder.path() / "out.exr").string());
}

double mean_of(const Picture& picture, std::size_t channel, std::uint32_t left, std::uint32_t right) {
  double sum = 0.0;
  for (std::uint32_t y = 0; y < picture.height; ++y)
    for (std::uint32_t x = left; x < right; ++x)
      sum += static_cast<double>(picture.channels[channel].values[std::size_t{y} * picture.width + x]);
  return sum / (picture.height * (right - left));
}

// A square lamp of side 1 that faces the floor from a height of 1: light that the point below its middle reflects.
double under_the_lamp(double radiance, double reflectance) {
  const double x = 0.5, r = std::sqrt(1.0 + x * x);
  const double quarter = (x / r * std::atan(x / r) * 2.0) / (2.0 * 3.141592653589793);
  return radiance * reflectance * 4.0 * quarter;
}

void expect_lamp(const Picture& picture) {
  const double light[3] = {2.0, 4.0, 8.0}, floor[3] = {0.5, 0.25, 1.0};
  for (std::size_t c = 0; c < 3; ++c) {
    const double expected = under_the_lamp(light[c], floor[c]);
    EXPECT_NEAR(mean_of(picture, c, 0, picture.width), expected, 0.01 * expected) << c;
  }
}

TEST(ConvertRender, ALampOfPbrtLightsAFloor) {
  const TempFolder folder;
  expect_lamp(rendered(
      folder, "scene.pbrt",
      "LookAt 0 0.5 -2  0 0 0  0 1 0\nCamera \"perspective\" \"float fov\" .2\n"
      "Film \"rgb\" \"integer xresolution\" 16 \"integer yresolution\" 16\nWorldBegin\nAttributeBegin\n"
      "AreaLightSource \"diffuse\" \"rgb L\" [2 4 8]\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
      "Shape \"trianglemesh\" \"point3 P\" [-.5 1 -.5 .5 1 -.5 .5 1 .5 -.5 1 .5] \"integer indices\" [0 1 2 0 2 3]\n"
      "AttributeEnd\nMaterial \"diffuse\" \"rgb reflectance\" [.5 .25 1]\n"
      "Shape \"trianglemesh\" \"point3 P\" [-9 0 -9 9 0 -9 9 0 9 -9 0 9] \"integer indices\" [0 1 2 0 2 3]\n"));
}

TEST(ConvertRender, ALampOfMitsubaLightsAFloor) {
  const TempFolder folder;
  expect_lamp(rendered(
      folder, "scene.xml",
      "<scene version='3.0.0'><integrator type='path'><integer name='max_depth' value='4'/></integrator>"
      "<sensor type='perspective'><float name='fov' value='.2'/><transform name='to_world'>"
      "<lookat origin='0,.5,-2' target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'><integer name='width' "
      "value='16'/>"
      "<integer name='height' value='16'/></film></sensor><shape type='rectangle'><transform name='to_world'>"
      "<scale value='.5'/><rotate x='1' angle='90'/><translate y='1'/></transform><bsdf type='diffuse'>"
      "<rgb name='reflectance' value='0'/></bsdf><emitter type='area'><rgb name='radiance' "
      "value='2,4,8'/></emitter></shape>"
      "<shape type='rectangle'><transform name='to_world'><scale value='9'/><rotate x='1' angle='-90'/></transform>"
      "<bsdf type='diffuse'><rgb name='reflectance' value='.5,.25,1'/></bsdf></shape></scene>"));
}

// A lamp at +X shows on the right of a picture of pbrt, and on the left of one of Mitsuba.
TEST(ConvertRender, PicturesAreNotMirrored) {
  const TempFolder folder;
  const Picture pbrt = rendered(folder, "scene.pbrt",
                                "LookAt 0 0 -5  0 0 0  0 1 0\nCamera \"perspective\"\nFilm \"rgb\" \"integer "
                                "xresolution\" 16 \"integer yresolution\" 16\n"
                                "WorldBegin\nTranslate 2 0 0\nAreaLightSource \"diffuse\"\nShape \"sphere\"\n");
  EXPECT_GT(mean_of(pbrt, 0, 8, 16), 0.05);
  EXPECT_EQ(mean_of(pbrt, 0, 0, 8), 0.0);
  const Picture mitsuba = rendered(
      folder, "scene.xml",
      "<scene version='3.0.0'><sensor type='perspective'><float name='fov' value='90'/><transform name='to_world'>"
      "<lookat origin='0,0,-5' target='0,0,0' up='0,1,0'/></transform><film type='hdrfilm'><integer name='width' "
      "value='16'/>"
      "<integer name='height' value='16'/></film></sensor><shape type='sphere'><point name='center' x='2' y='0' z='0'/>"
      "<emitter type='area'/></shape></scene>");
  EXPECT_GT(mean_of(mitsuba, 0, 0, 8), 0.05);
  EXPECT_EQ(mean_of(mitsuba, 0, 8, 16), 0.0);
}

} // namespace
} // namespace wavepath::test
