// The filters over time, on pictures whose truth is known: noise is removed, edges and values without noise stay, the
// history moves with the camera.
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "host/integrators/hybrid/antialias/kinds.h"
#include "host/integrators/hybrid/denoise.h"
#include "host/integrators/hybrid/taa.h"
#include "kernels/hybrid/filter_types.h"
#include "kernels/hybrid/hybrid_types.h"
#include "tests/probe.h"

namespace wavepath::test {
namespace {

using glm::vec2;
using glm::vec3;
using glm::vec4;
using gpu::CameraView;
using gpu::GbufferPixel;
using Signals = std::vector<vec4>;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::uint32_t kBoth = gpu::kHybridLights | gpu::kHybridAmbient;

CameraView camera(std::uint32_t width, std::uint32_t height) {
  CameraView view{};
  view.right = vec3(0.5f * static_cast<float>(width) / static_cast<float>(height), 0.0f, 0.0f);
  view.up = vec3(0.0f, 0.5f, 0.0f);
  view.forward = vec3(0.0f, 0.0f, -1.0f);
  return view;
}

CameraView orthographic(std::uint32_t width, std::uint32_t height) {
  CameraView view = camera(width, height);
  view.orthographic = 1;
  view.right *= 4.0f;
  view.up *= 4.0f;
  return view;
}

// About the vertical axis.
CameraView turned(CameraView view, float radians) {
  const auto turn = [&](vec3 v) {
    const float c = std::cos(radians), s = std::sin(radians);
    return vec3(c * v.x + s * v.z, v.y, c * v.z - s * v.x);
  };
  view.right = turn(view.right);
  view.forward = turn(view.forward);
  return view;
}

// A rectangle across the z axis, facing +z.
struct Board {
  float z = -4.0f;
  float low_x = -1e6f, high_x = 1e6f;
  std::uint32_t surface = 1;
};

// What a camera sees of boards, and where.
struct Shot {
  std::uint32_t width, height;
  std::vector<GbufferPixel> gbuffer;
  std::vector<vec3> points; // of the world
  std::vector<int> boards;  // -1 = sky
};

Shot shoot(std::uint32_t width, std::uint32_t height, const CameraView& view, const std::vector<Board>& boards) {
  Shot shot{width, height, std::vector<GbufferPixel>(width * height), std::vector<vec3>(width * height),
            std::vector<int>(width * height, -1)};
  for (std::uint32_t i = 0; i < width * height; ++i) {
    const vec2 place = vec2(i % width, i / width) + 0.5f + vec2(view.jitter_x, view.jitter_y);
    const vec3 aside = (2.0f * place.x / static_cast<float>(width) - 1.0f) * view.right +
                       (1.0f - 2.0f * place.y / static_cast<float>(height)) * view.up;
    const vec3 origin = view.position + (view.orthographic ? aside : vec3(0.0f));
    const vec3 direction = view.forward + (view.orthographic ? vec3(0.0f) : aside);
    for (std::size_t b = 0; b < boards.size(); ++b) {
      const float t = (boards[b].z - origin.z) / direction.z; // = depth, because direction . forward = 1
      const vec3 point = origin + t * direction;
      if (t <= 0.0f || point.x < boards[b].low_x || point.x > boards[b].high_x) continue;
      if (shot.boards[i] >= 0 && t >= shot.gbuffer[i].depth) continue;
      shot.gbuffer[i] = {vec3(0.0f, 0.0f, 1.0f), t, vec3(0.5f), boards[b].surface};
      shot.points[i] = point;
      shot.boards[i] = static_cast<int>(b);
    }
  }
  return shot;
}

Shot wall(std::uint32_t width, std::uint32_t height) { return shoot(width, height, camera(width, height), {Board{}}); }

Signals fill(const Shot& shot, const std::function<vec4(std::size_t)>& signal) {
  Signals signals(shot.gbuffer.size());
  for (std::size_t i = 0; i < signals.size(); ++i) signals[i] = signal(i);
  return signals;
}

// Direct light 1 with a standard deviation of 0.5, the unoccluded fraction 0 or 1.
Signals noise(const Shot& shot, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform;
  return fill(shot, [&](std::size_t) {
    const float light = 1.0f + (uniform(random) - 0.5f) * std::sqrt(3.0f);
    return vec4(vec3(light), uniform(random) < 0.5f ? 0.0f : 1.0f);
  });
}

// A pattern that no two pixels share; values without noise must stay as they are.
Signals pattern(const Shot& shot) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> uniform;
  return fill(shot,
              [&](std::size_t) { return vec4(uniform(random), uniform(random), uniform(random), uniform(random)); });
}

double rms(const Signals& a, const std::function<double(std::size_t)>& truth, int channel) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += std::pow(a[i][channel] - truth(i), 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

bool finite(const Signals& signals) {
  for (const vec4& s : signals)
    for (int c = 0; c < 4; ++c)
      if (!std::isfinite(s[c])) return false;
  return true;
}

bool same_bits(const Signals& a, const Signals& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(vec4)) == 0;
}

// Frames of one size through one filter.
class DenoiseTest : public VulkanTest {
protected:
  void begin(std::uint32_t width, std::uint32_t height, std::uint32_t wanted = kBoth) {
    denoiser_.reset();
    gbuffer_ = Buffer(device(), std::uint64_t{width} * height * sizeof(GbufferPixel));
    signals_ = Buffer(device(), std::uint64_t{width} * height * sizeof(vec4));
    denoiser_ = std::make_unique<Denoiser>(device(), width, height, gbuffer_, signals_, wanted);
  }
  Signals filter(const Shot& shot, const CameraView& view, const Signals& signals) {
    gbuffer_.write(shot.gbuffer.data(), shot.gbuffer.size() * sizeof(GbufferPixel));
    signals_.write(signals.data(), signals.size() * sizeof(vec4));
    Commands commands(device());
    denoiser_->record(commands, view);
    commands.submit_and_wait();
    return download<vec4>(signals_, signals.size());
  }
  Signals filter(const Shot& shot, const Signals& signals) {
    return filter(shot, camera(shot.width, shot.height), signals);
  }

  Buffer gbuffer_, signals_;
  std::unique_ptr<Denoiser> denoiser_;
};

// Five iterations of the B3 spline with nothing in the way have a standard deviation of sqrt(1 + 4 + ... + 256) = 18.5
// pixels: as wide as a Gaussian that leaves 1 / (2 sqrt(pi) 18.5) = 0.015 of white noise. Luminance weights cost most
// of that, because noise that has been filtered is correlated and its variance, estimated as if it were not, too small.
// Two iterations without luminance weights would leave 0.13.
TEST_F(DenoiseTest, FlatNoiseIsFilteredFromTheFirstFrame) {
  const Shot shot = wall(128, 128);
  begin(128, 128);
  const Signals in = noise(shot, 1), out = filter(shot, in);
  EXPECT_LT(rms(
                out, [](std::size_t) { return 1.0; }, 0),
            0.1 * 0.5);
  EXPECT_LT(rms(
                out, [](std::size_t) { return 0.5; }, 3),
            0.1 * 0.5);
}

// One light of fifty is seen. Luminance weights alone would keep what is bright to its pixels, where few can see it,
// and most of the light would be missing elsewhere: 0.4 of it was left, with an error of 0.8.
TEST_F(DenoiseTest, RareBrightSamplesAreSpread) {
  const Shot shot = wall(128, 128);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> uniform;
  const float chance = 0.02f;
  const Signals in =
      fill(shot, [&](std::size_t) { return vec4(vec3(uniform(random) < chance ? 1.0f / chance : 0.0f), 0.5f); });
  begin(128, 128);
  const Signals out = filter(shot, in);
  double before = 0.0, after = 0.0;
  for (std::size_t i = 0; i < out.size(); ++i) before += in[i].x, after += out[i].x;
  EXPECT_NEAR(after / before, 1.0, 0.05);
  EXPECT_LT(rms(
                out, [](std::size_t) { return 1.0; }, 0),
            0.3);
  for (std::size_t i = 0; i < out.size(); ++i) EXPECT_EQ(out[i].w, in[i].w);
}

// They go over the surface that they were on alone.
TEST_F(DenoiseTest, RareBrightSamplesStayOnTheirSurface) {
  const std::uint32_t size = 64;
  Shot shot = wall(size, size);
  for (std::size_t i = 0; i < shot.gbuffer.size(); ++i)
    if (i % size >= size / 2) shot.gbuffer[i].surface = 2;
  Signals in = fill(shot, [](std::size_t) { return vec4(0.0f); });
  for (std::size_t i = 5; i < in.size(); i += 7 * size + 11)
    if (i % size < size / 2) in[i] = vec4(100.0f);
  begin(size, size);
  const Signals out = filter(shot, in);
  for (std::size_t i = 0; i < out.size(); ++i)
    if (i % size >= size / 2) {
      EXPECT_EQ(vec3(out[i]), vec3(0.0f)) << i;
    }
}

TEST_F(DenoiseTest, NoiseFallsWithTheFramesInStillPictures) {
  const Shot shot = wall(64, 64);
  const Signals truth = pattern(shot);
  begin(64, 64);
  std::vector<double> errors; // after 1, 2, 3, ... frames
  for (std::uint32_t frame = 0; frame < 256; ++frame) {
    Signals in = noise(shot, frame);
    for (std::size_t i = 0; i < in.size(); ++i)
      in[i] = vec4(vec3(in[i].x - 1.0f), in[i].w - 0.5f) + 10.0f * vec4(vec3(truth[i].x), truth[i].w);
    const Signals out = filter(shot, in);
    errors.push_back(std::hypot(rms(
                                    out, [&](std::size_t i) { return 10.0f * truth[i].x; }, 0),
                                rms(
                                    out, [&](std::size_t i) { return 10.0f * truth[i].w; }, 3)));
  }
  const double single = std::hypot(0.5, 0.5);
  // The mean over frames alone has single / sqrt(frames). Pixels that are alike by chance are mixed until their errors
  // are small enough to tell them apart, which costs some of that.
  EXPECT_LT(errors[63], 1.5 * single / 8.0);
  EXPECT_LT(errors[255], 1.5 * single / 16.0);
  EXPECT_LT(errors[255], 0.55 * errors[63]);
}

TEST_F(DenoiseTest, EdgesOfSurfacesAreNotCrossed) {
  const std::uint32_t size = 48;
  for (const char* edge : {"surface", "normal", "depth"}) {
    SCOPED_TRACE(edge);
    Shot shot = wall(size, size);
    for (std::size_t i = 0; i < shot.gbuffer.size(); ++i) {
      if (i % size < size / 2) continue;
      if (edge == std::string("surface")) shot.gbuffer[i].surface = 2;
      if (edge == std::string("normal")) shot.gbuffer[i].normal = vec3(0.8f, 0.0f, 0.6f);
      if (edge == std::string("depth")) shot.gbuffer[i].depth = 4.4f;
    }
    begin(size, size);
    Signals in = noise(shot, 3);
    for (std::size_t i = 0; i < in.size(); ++i)
      if (i % size >= size / 2) in[i] = in[i] * 100.0f + 1000.0f;
    for (int frame = 0; frame < 2; ++frame) { // of the past, and of a single frame
      const Signals out = filter(shot, in);
      double left = 0.0, right = 0.0;
      for (std::size_t i = 0; i < out.size(); ++i) {
        const bool is_left = i % size < size / 2;
        EXPECT_TRUE(is_left ? out[i].x < 2.0f && out[i].w <= 1.0f : out[i].x > 1000.0f && out[i].w >= 1000.0f) << i;
        if (i % size == size / 2 - 1) left += out[i].x / size;
        if (i % size == size / 2) right += out[i].x / size;
      }
      EXPECT_NEAR(left, 1.0, 0.1); // the columns at the edge are filtered, too
      EXPECT_NEAR(right, 1100.0, 10.0);
    }
  }
}

TEST_F(DenoiseTest, ShadowEdgesStaySharp) {
  const std::uint32_t size = 64;
  const Shot shot = wall(size, size);
  begin(size, size);
  Signals out;
  for (std::uint32_t frame = 0; frame < 8; ++frame) {
    Signals in = noise(shot, frame);
    for (std::size_t i = 0; i < in.size(); ++i) {
      const float lit = i % size < size / 2 ? 1.0f : 0.0f;
      in[i] = vec4(vec3(lit + 0.1f * (in[i].x - 1.0f)), lit + 0.1f * (in[i].w - 0.5f)); // deviations of 0.05
    }
    out = filter(shot, in);
  }
  const auto truth = [&](std::size_t i) { return i % size < size / 2 ? 1.0 : 0.0; };
  for (std::size_t i = 0; i < out.size(); ++i) {
    EXPECT_NEAR(out[i].x, truth(i), 0.05) << i;
    EXPECT_NEAR(out[i].w, truth(i), 0.05) << i;
  }
  EXPECT_LT(rms(out, truth, 0), 0.25 * 0.05 / std::sqrt(8.0)); // and both sides are filtered
}

TEST_F(DenoiseTest, WhatIsCertainStaysToTheBit) {
  const Shot shot = wall(40, 24);
  begin(40, 24);
  const Signals flat = fill(shot, [](std::size_t) { return vec4(0.3f, 7.1f, 1e-3f, 0.7f); });
  EXPECT_TRUE(same_bits(filter(shot, flat), flat));
  denoiser_->forget();
  const Signals in = pattern(shot);
  Signals out;
  for (int frame = 0; frame < 4; ++frame) out = filter(shot, in);
  EXPECT_TRUE(same_bits(out, in));
}

TEST_F(DenoiseTest, WhatIsNotWantedPassesThrough) {
  const Shot shot = wall(40, 24);
  const Signals in = noise(shot, 5);
  begin(40, 24, gpu::kHybridLights);
  for (int frame = 0; frame < 3; ++frame) {
    const Signals out = filter(shot, in);
    for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(out[i].w, in[i].w);
    EXPECT_LT(rms(
                  out, [](std::size_t) { return 1.0; }, 1),
              0.1);
  }
  begin(40, 24, gpu::kHybridAmbient);
  for (int frame = 0; frame < 3; ++frame) {
    const Signals out = filter(shot, in);
    for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(vec3(out[i]), vec3(in[i]));
    EXPECT_LT(rms(
                  out, [](std::size_t) { return 0.5; }, 3),
              0.1);
  }
}

TEST_F(DenoiseTest, TheSkyPassesThrough) {
  const CameraView view = camera(40, 24);
  const Shot shot = shoot(40, 24, view, {Board{.high_x = 0.0f}});
  begin(40, 24);
  const Signals in = noise(shot, 5), out = filter(shot, view, in);
  std::size_t sky = 0;
  for (std::size_t i = 0; i < in.size(); ++i)
    if (shot.boards[i] < 0) {
      ++sky;
      EXPECT_EQ(out[i], in[i]);
    }
  EXPECT_EQ(sky, in.size() / 2);
}

// ---- cameras in motion
// ------------------------------------------------------------------------------------------------

// Light that lies on the wall like paint, in waves about as wide as the picture.
float paint(vec3 point) { return 2.0f + std::sin(1.5f * point.x) * std::cos(1.2f * point.y); }

struct Move {
  const char* name;
  CameraView first;
  std::function<CameraView(CameraView)> step;
};

std::vector<Move> moves(std::uint32_t width, std::uint32_t height) {
  const CameraView at = camera(width, height);
  const auto slide = [](CameraView view) {
    view.position += vec3(0.37f, 0.06f, 0.0f);
    return view;
  };
  return {{"slide", at, slide},
          {"turn", at, [](CameraView view) { return turned(view, 0.04f); }},
          {"dolly", at,
           [](CameraView view) {
             view.position += vec3(0.0f, 0.0f, -0.3f);
             return view;
           }},
          {"orthographic slide", orthographic(width, height), slide}};
}

// The last frame brings no values at all, so that what comes out is what the filter remembers.
TEST_F(DenoiseTest, TheHistoryMovesWithTheCamera) {
  const std::uint32_t width = 96, height = 64;
  for (const Move& move : moves(width, height)) {
    SCOPED_TRACE(move.name);
    begin(width, height);
    CameraView view = move.first;
    for (int frame = 0; frame < 6; ++frame) {
      const Shot shot = shoot(width, height, view, {Board{}});
      filter(shot, view,
             fill(shot, [&](std::size_t i) { return vec4(vec3(paint(shot.points[i])), paint(shot.points[i])); }));
      view = move.step(view);
    }
    const Shot shot = shoot(width, height, view, {Board{}});
    const Signals out = filter(shot, view, fill(shot, [](std::size_t) { return vec4(kNan); }));
    for (std::uint32_t y = 12; y + 12 < height; ++y)
      for (std::uint32_t x = 12; x + 12 < width; ++x) { // what was in the picture before
        const std::size_t i = y * width + x;
        EXPECT_NEAR(out[i].x, paint(shot.points[i]), 0.1) << x << ' ' << y;
        EXPECT_NEAR(out[i].w, paint(shot.points[i]), 0.1) << x << ' ' << y;
      }
  }
}

TEST_F(DenoiseTest, WhatComesIntoViewHasNoHistory) {
  const std::uint32_t width = 96, height = 32;
  for (std::uint32_t foreground : {1u, 2u}) { // a surface that stands before itself, and before another
    SCOPED_TRACE(foreground);
    const std::vector<Board> boards = {Board{}, {.z = -2.0f, .low_x = -0.4f, .high_x = 0.4f, .surface = foreground}};
    begin(width, height);
    CameraView view = camera(width, height);
    for (int frame = 0; frame < 6; ++frame) {
      const Shot shot = shoot(width, height, view, boards);
      const auto light = [&](std::size_t i) { return shot.boards[i] == 1 ? 100.0f : paint(shot.points[i]); };
      const Signals out = filter(shot, view, fill(shot, [&](std::size_t i) { return vec4(light(i)); }));
      for (std::size_t i = 0; i < out.size(); ++i) {
        EXPECT_NEAR(out[i].x, light(i), 1.0) << frame << ' ' << i;
        EXPECT_NEAR(out[i].w, light(i), 1.0) << frame << ' ' << i;
      }
      view.position.x += 0.21f;
    }
  }
}

TEST_F(DenoiseTest, JitterDoesNotWearStillPicturesOut) {
  const std::uint32_t size = 48;
  begin(size, size);
  CameraView view = camera(size, size);
  Signals in, out;
  for (int frame = 0; frame < 64; ++frame) {
    view.jitter_x = static_cast<float>(frame * 5 % 8) / 8.0f - 0.4375f;
    view.jitter_y = static_cast<float>(frame * 3 % 8) / 8.0f - 0.4375f;
    const Shot shot = shoot(size, size, view, {Board{}});
    in = pattern(shot);
    out = filter(shot, view, in);
  }
  EXPECT_TRUE(same_bits(out, in));
}

TEST_F(DenoiseTest, ForgettingIsComplete) {
  const Shot shot = wall(32, 32);
  begin(32, 32);
  const Signals in = noise(shot, 1);
  const Signals first = filter(shot, in);
  for (std::uint32_t frame = 2; frame < 6; ++frame) filter(shot, noise(shot, frame));
  EXPECT_FALSE(same_bits(filter(shot, in), first));
  denoiser_->forget();
  EXPECT_TRUE(same_bits(filter(shot, in), first));
}

// ---- what must not happen
// ---------------------------------------------------------------------------------------------

TEST_F(DenoiseTest, ValuesThatAreNotFiniteDoNotSpread) {
  const Shot shot = wall(40, 24);
  const Signals flat = fill(shot, [](std::size_t) { return vec4(0.25f, 3.0f, 1.0f, 0.5f); });
  begin(40, 24);
  for (int frame = 0; frame < 6; ++frame) {
    Signals in = flat;
    in[500].y = kNan;
    in[501] = vec4(-kInfinity, 1.0f, 1.0f, kInfinity);
    in[777].w = kNan;
    in[0] = vec4(3e38f);
    const Signals out = filter(shot, in);
    for (std::size_t i = 0; i < out.size(); ++i)
      for (int c = 0; c < 4; ++c) EXPECT_NEAR(out[i][c], flat[i][c], 1e-6) << i;
  }
  denoiser_->forget();
  EXPECT_TRUE(finite(filter(shot, fill(shot, [](std::size_t) { return vec4(kNan); }))));
}

TEST_F(DenoiseTest, AnySizeWill) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {3u, 2u}, {1u, 50u}, {67u, 13u}}) {
    SCOPED_TRACE(testing::Message() << width << 'x' << height);
    const Shot shot = wall(width, height);
    begin(width, height);
    for (std::uint32_t frame = 0; frame < 3; ++frame) EXPECT_TRUE(finite(filter(shot, noise(shot, frame))));
    denoiser_->forget();
    const Signals flat = fill(shot, [](std::size_t) { return vec4(0.3f); });
    EXPECT_TRUE(same_bits(filter(shot, flat), flat));
  }
}

TEST_F(DenoiseTest, SameBitsTwice) {
  const auto run = [&] {
    begin(70, 50);
    CameraView view = camera(70, 50);
    Signals out;
    for (std::uint32_t frame = 0; frame < 4; ++frame) {
      const Shot shot = shoot(70, 50, view, {Board{}, {.z = -3.0f, .low_x = 0.2f, .high_x = 0.7f}});
      out = filter(shot, view, noise(shot, frame));
      if (frame % 2) view.position.x += 0.05f;
    }
    return out;
  };
  const Signals first = run();
  EXPECT_TRUE(same_bits(run(), first));
}

// ---- temporal anti-aliasing
// -------------------------------------------------------------------------------------------

class TaaTest : public VulkanTest {
protected:
  void begin(std::uint32_t width, std::uint32_t height) {
    taa_.reset();
    gbuffer_ = Buffer(device(), std::uint64_t{width} * height * sizeof(GbufferPixel));
    color_ = Buffer(device(), std::uint64_t{width} * height * sizeof(vec4));
    taa_ = std::make_unique<Taa>(device(), width, height, gbuffer_, color_);
  }
  Signals join(const Shot& shot, const CameraView& view, const Signals& color) {
    gbuffer_.write(shot.gbuffer.data(), shot.gbuffer.size() * sizeof(GbufferPixel));
    color_.write(color.data(), color.size() * sizeof(vec4));
    Commands commands(device());
    taa_->record(commands, view);
    commands.submit_and_wait();
    return download<vec4>(taa_->result(), color.size());
  }

  Buffer gbuffer_, color_;
  std::unique_ptr<Taa> taa_;
};

TEST_F(TaaTest, OutlinesOfStillPicturesBecomeSmooth) {
  const std::uint32_t width = 40, height = 24;
  begin(width, height);
  CameraView view = camera(width, height);
  // The outline covers 0.35 of its pixels: a pixel is 4 * 2 * 0.8333 / 40 = 1/6 wide.
  const std::vector<Board> boards = {Board{}, {.high_x = 2.35f / 6.0f, .surface = 2}};
  const auto color = [](int board) { return board == 0 ? 0.20f : 0.24f; };
  std::vector<Board> in_front = boards;
  in_front[1].z = -3.999f;
  Signals out;
  for (int frame = 0; frame < 40; ++frame) {
    view.jitter_x = static_cast<float>(frame * 3 % 10) / 10.0f - 0.45f;
    const Shot shot = shoot(width, height, view, in_front);
    out = join(shot, view, fill(shot, [&](std::size_t i) { return vec4(color(shot.boards[i])); }));
  }
  for (std::uint32_t x = 0; x < width; ++x) {
    const float covered = x < 22 ? 1.0f : x == 22 ? 0.35f : 0.0f;
    EXPECT_NEAR(out[12 * width + x].x, 0.20f + 0.04f * covered, x == 22 ? 0.15f * 0.04f : 1e-6f) << x;
    EXPECT_EQ(out[12 * width + x].w, 10.0f);
  }
}

TEST_F(TaaTest, TheHistoryMovesWithTheCamera) {
  const std::uint32_t width = 96, height = 64;
  for (const Move& move : moves(width, height)) {
    SCOPED_TRACE(move.name);
    begin(width, height);
    CameraView view = move.first;
    for (int frame = 0; frame < 6; ++frame) {
      const Shot shot = shoot(width, height, view, {Board{}});
      join(shot, view, fill(shot, [&](std::size_t i) { return vec4(paint(shot.points[i])); }));
      view = move.step(view);
    }
    const Shot shot = shoot(width, height, view, {Board{}});
    const Signals out = join(shot, view, fill(shot, [](std::size_t) { return vec4(kNan); }));
    for (std::uint32_t y = 12; y + 12 < height; ++y)
      for (std::uint32_t x = 12; x + 12 < width; ++x) {
        const std::size_t i = y * width + x;
        EXPECT_NEAR(out[i].x, paint(shot.points[i]), 0.04) << x << ' ' << y;
      }
  }
}

// The sky, infinitely far, moves by rotation alone.
TEST_F(TaaTest, TheSkyTurnsAndDoesNotSlide) {
  const std::uint32_t width = 64, height = 32;
  const auto sky = [&](const CameraView& view, std::size_t i) {
    const vec3 direction = view.forward + (2.0f * (static_cast<float>(i % width) + 0.5f) / width - 1.0f) * view.right;
    return vec4(1.0f + std::sin(10.0f * std::atan2(direction.x, -direction.z)));
  };
  begin(width, height);
  CameraView view = camera(width, height);
  const Shot nothing = shoot(width, height, view, {});
  join(nothing, view, fill(nothing, [&](std::size_t i) { return sky(view, i); }));
  view = turned(view, 0.05f);
  view.position.x += 10.0f;
  const Signals out = join(nothing, view, fill(nothing, [](std::size_t) { return vec4(kNan); }));
  for (std::size_t i = 0; i < out.size(); ++i)
    if (i % width > 8 && i / width > 0 && i / width < height - 1) { // what was in the picture before
      EXPECT_NEAR(out[i].x, sky(view, i).x, 0.01) << i;
    }
}

TEST_F(TaaTest, NoGhostStaysBehind) {
  const std::uint32_t width = 96, height = 32;
  const std::vector<Board> boards = {Board{}, {.z = -2.0f, .low_x = -0.4f, .high_x = 0.4f, .surface = 2}};
  begin(width, height);
  CameraView view = camera(width, height);
  for (int frame = 0; frame < 6; ++frame) {
    const Shot shot = shoot(width, height, view, boards);
    const auto light = [&](std::size_t i) { return shot.boards[i] == 1 ? 50.0f : 0.1f; };
    const Signals out = join(shot, view, fill(shot, [&](std::size_t i) { return vec4(light(i)); }));
    for (std::uint32_t x = 1; x + 1 < width; ++x) { // but on outlines, where both colours are in the clip box
      const std::size_t i = 16 * width + x;
      if (light(i - 1) == light(i) && light(i) == light(i + 1)) {
        EXPECT_NEAR(out[i].x, light(i), 0.01f * light(i)) << frame << ' ' << x;
      }
    }
    view.position.x += 0.21f;
  }
}

TEST_F(TaaTest, ValuesThatAreNotFiniteDoNotSpread) {
  const Shot shot = wall(40, 24);
  const CameraView view = camera(40, 24);
  begin(40, 24);
  for (int frame = 0; frame < 3; ++frame) {
    Signals in = fill(shot, [](std::size_t) { return vec4(0.25f, 3.0f, 1.0f, 1.0f); });
    in[500].y = kNan;
    in[501].x = kInfinity;
    const Signals out = join(shot, view, in);
    for (std::size_t i = 0; i < out.size(); ++i) EXPECT_NEAR(out[i].y, 3.0f, 1e-5f) << i;
  }
  taa_->forget();
  EXPECT_TRUE(finite(join(shot, view, fill(shot, [](std::size_t) { return vec4(kNan); }))));
}

TEST_F(TaaTest, AfterACutThereIsOnlyThisFrame) {
  for (const auto& [width, height] : {std::pair{1u, 1u}, {3u, 2u}, {67u, 13u}}) {
    const Shot shot = wall(width, height);
    const CameraView view = camera(width, height);
    begin(width, height);
    for (std::uint32_t frame = 0; frame < 3; ++frame) join(shot, view, noise(shot, frame));
    taa_->forget();
    const Signals in = pattern(shot), out = join(shot, view, in);
    for (std::size_t i = 0; i < in.size(); ++i) EXPECT_EQ(out[i], vec4(vec3(in[i]), 1.0f));
  }
}

// ---- temporal upscaling
// -------------------------------------------------------------------------------------------

constexpr std::array<std::uint32_t, 4> kPlaces = {0, 3, 1, 2}; // in squares of 2x2 pixels, row by row

// Frames see one pixel of each square.
class UpscaleTest : public VulkanTest {
protected:
  void begin(std::uint32_t width, std::uint32_t height) {
    upscale_.reset();
    half_ = glm::uvec2(width + 1, height + 1) / 2u;
    gbuffer_ = Buffer(device(), std::uint64_t{half_.x} * half_.y * sizeof(GbufferPixel));
    color_ = Buffer(device(), std::uint64_t{half_.x} * half_.y * sizeof(vec4));
    upscale_ = std::make_unique<Taa>(device(), width, height, gbuffer_, color_, kAntialiasUpscale.joining());
  }
  // `shot` and `color` are of all pixels.
  Signals join(const Shot& shot, const CameraView& view, const Signals& color, std::uint32_t place) {
    std::vector<GbufferPixel> gbuffer;
    Signals seen;
    for (std::uint32_t i = 0; i < half_.x * half_.y; ++i) {
      const std::uint32_t x = std::min(2 * (i % half_.x) + (place & 1), shot.width - 1),
                          y = std::min(2 * (i / half_.x) + (place >> 1), shot.height - 1);
      gbuffer.push_back(shot.gbuffer[y * shot.width + x]);
      seen.push_back(color[y * shot.width + x]);
    }
    gbuffer_.write(gbuffer.data(), gbuffer.size() * sizeof(GbufferPixel));
    color_.write(seen.data(), seen.size() * sizeof(vec4));
    Commands commands(device());
    upscale_->record(commands, view, place);
    commands.submit_and_wait();
    return download<vec4>(upscale_->result(), color.size());
  }

  glm::uvec2 half_{0};
  Buffer gbuffer_, color_;
  std::unique_ptr<Taa> upscale_;
};

// Whatever the pixels show, four frames have seen all of them; before, each frame shows its own.
TEST_F(UpscaleTest, FourFramesOfAStillCameraAreThePicture) {
  for (const auto& [width, height] : {std::pair{40u, 24u}, {37u, 11u}, {1u, 1u}}) {
    const Shot shot = wall(width, height);
    const CameraView view = camera(width, height);
    const Signals in = pattern(shot);
    begin(width, height);
    std::vector<bool> known(in.size());
    for (const std::uint32_t place : kPlaces) {
      const Signals out = join(shot, view, in, place);
      for (std::uint32_t i = 0; i < in.size(); ++i) {
        if ((i % width & 1) == (place & 1) && (i / width & 1) == place >> 1) known[i] = true;
        EXPECT_EQ(out[i].w, known[i] ? 1.0f : 0.0f) << i;
        if (known[i]) {
          EXPECT_EQ(vec3(out[i]), vec3(in[i])) << i;
        }
      }
    }
    EXPECT_EQ(std::ranges::count(known, true), static_cast<std::ptrdiff_t>(in.size()));
  }
}

// A pixel that no frame has seen lies between those that were: a slope stays a slope.
TEST_F(UpscaleTest, UnknownPixelsAreInterpolated) {
  const std::uint32_t width = 40, height = 24;
  const Shot shot = wall(width, height);
  const Signals slope = fill(
      shot, [&](std::size_t i) { return vec4(2.0f + 0.5f * (i % width) + 0.25f * static_cast<float>(i / width)); });
  for (const std::uint32_t place : kPlaces) {
    begin(width, height);
    const Signals out = join(shot, camera(width, height), slope, place);
    for (std::uint32_t y = 2; y + 2 < height; ++y)
      for (std::uint32_t x = 2; x + 2 < width; ++x)
        EXPECT_NEAR(out[y * width + x].x, slope[y * width + x].x, 1e-5) << place << ": " << x << ' ' << y;
  }
}

TEST_F(UpscaleTest, TheHistoryMovesWithTheCamera) {
  const std::uint32_t width = 96, height = 64;
  for (const Move& move : moves(width, height)) {
    SCOPED_TRACE(move.name);
    begin(width, height);
    CameraView view = move.first;
    for (std::uint32_t frame = 0; frame < 12; ++frame) {
      const Shot shot = shoot(width, height, view, {Board{}});
      join(shot, view, fill(shot, [&](std::size_t i) { return vec4(paint(shot.points[i])); }), kPlaces[frame % 4]);
      view = move.step(view);
    }
    const Shot shot = shoot(width, height, view, {Board{}});
    const Signals out = join(shot, view, fill(shot, [](std::size_t) { return vec4(kNan); }), kPlaces[0]);
    std::size_t known = 0;
    for (std::uint32_t y = 12; y + 12 < height; ++y)
      for (std::uint32_t x = 12; x + 12 < width; ++x) {
        const std::size_t i = y * width + x;
        if (out[i].w < 1.0f) continue;
        ++known;
        EXPECT_NEAR(out[i].x, paint(shot.points[i]), 0.06) << x << ' ' << y;
      }
    EXPECT_GT(known, (width - 24) * (height - 24) / 2);
  }
}

// Colours that are nowhere about a pixel any more leave its history, once the camera moves.
TEST_F(UpscaleTest, NoGhostStaysBehind) {
  const std::uint32_t width = 96, height = 32;
  const std::vector<Board> boards = {Board{}, {.z = -2.0f, .low_x = -0.4f, .high_x = 0.4f, .surface = 2}};
  begin(width, height);
  CameraView view = camera(width, height);
  for (std::uint32_t frame = 0; frame < 8; ++frame) {
    const Shot shot = shoot(width, height, view, boards);
    const auto light = [&](std::size_t i) { return shot.boards[i] == 1 ? 50.0f : 0.1f; };
    const Signals out = join(shot, view, fill(shot, [&](std::size_t i) { return vec4(light(i)); }), kPlaces[frame % 4]);
    for (std::uint32_t x = 4; x + 4 < width; ++x) { // but on outlines, where both colours are in the clip box
      const std::size_t i = 16 * width + x;
      bool even = true;
      for (std::size_t k = i - 4; k <= i + 4; ++k) even = even && light(k) == light(i);
      if (even) {
        EXPECT_NEAR(out[i].x, light(i), 0.01f * light(i)) << frame << ' ' << x;
      }
    }
    view.position.x += 0.21f;
  }
}

TEST_F(UpscaleTest, ValuesThatAreNotFiniteDoNotSpread) {
  const Shot shot = wall(40, 24);
  const CameraView view = camera(40, 24);
  begin(40, 24);
  for (std::uint32_t frame = 0; frame < 6; ++frame) {
    Signals in = fill(shot, [](std::size_t) { return vec4(0.25f, 3.0f, 1.0f, 1.0f); });
    in[500].y = kNan;
    in[501].x = kInfinity;
    EXPECT_TRUE(finite(join(shot, view, in, kPlaces[frame % 4])));
  }
}

} // namespace
} // namespace wavepath::test
