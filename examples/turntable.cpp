// Renders a scene from all around, the scene staying on the device: turntable SCENE FOLDER [COUNT].
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <wavepath/wavepath.h>

int main(int count, char** arguments) {
  if (count < 3) {
    std::fprintf(stderr, "usage: turntable SCENE FOLDER [COUNT]\n");
    return 2;
  }
  const std::string scene = arguments[1], folder = arguments[2];
  const int views = count > 3 ? std::atoi(arguments[3]) : 8;
  try {
    const wavepath::Settings settings{{"size", "160x120"}, {"spp", 8}, {"aov", "depth"}};
    wavepath::Session session({scene}, settings);
    const auto [low, high] = session.bounds();
    const wavepath::Point middle{(low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2};
    const double reach = std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
    for (int i = 0; i < views; ++i) {
      const double angle = 6.283185307179586 * i / views;
      wavepath::Camera camera;
      camera.eye = {middle[0] + reach * std::sin(angle), middle[1] + 0.2 * reach, middle[2] + reach * std::cos(angle)};
      camera.look_at = middle;
      const wavepath::Result picture = session.render(camera);
      picture.save(folder + "/view" + std::to_string(i) + ".png", {{"exposure", "auto"}});
      std::printf("view %d: %u spp in %.3f s, error %.3g\n", i, picture.spp(), picture.seconds(), picture.error());
    }
  } catch (const wavepath::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
