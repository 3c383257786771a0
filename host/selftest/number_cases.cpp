// Cases of numbers at the ends of their range: random numbers, texture coordinates, denormals, 16-bit pictures.
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include <fmt/format.h>

#include "host/gpu/commands.h"
#include "host/picture/files/picture_io.h"
#include "host/render/settings/textures.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/traced_scene.h"
#include "kernels/selftest/selftest_texture.spv.h"
#include "kernels/selftest/selftest_unit_float.spv.h"

namespace wavepath {
namespace {

// All 2^32 words: 0 <= u < 1, both ends as they should be.
Measurement unit_interval(const SelftestContext& context) {
  struct Parameters {
    std::uint32_t first_word, words_per_lane;
  };
  constexpr std::uint32_t kLanes = 1u << 14, kWordsPerLane = 1u << 11; // a few hundredths of a second on a slow CPU
  const Buffer results(context.device, kLanes * sizeof(glm::uvec2));
  const Binding all[] = {{0, BindingKind::storage, &results}};
  const BindingSet bindings(context.device, all, sizeof(Parameters));
  const Kernel kernel(context.device, "unit_float", wavepath_selftest_unit_float_spv, bindings, {});
  std::uint32_t lowest = 0xffffffffu, highest = 0;
  constexpr std::uint64_t kWords = std::uint64_t{1} << 32, kAtOnce = std::uint64_t{kLanes} * kWordsPerLane;
  for (std::uint64_t first = 0; first < kWords; first += kAtOnce) {
    const Parameters parameters{static_cast<std::uint32_t>(first), kWordsPerLane};
    Commands commands(context.device);
    commands.bind(bindings);
    commands.dispatch(kernel, kLanes / gpu::kWorkgroupSize, &parameters);
    commands.submit_and_wait();
    for (const glm::uvec2& found : download<glm::uvec2>(results, kLanes))
      lowest = std::min(lowest, found.x), highest = std::max(highest, found.y);
  }
  const float low = std::bit_cast<float>(lowest), high = std::bit_cast<float>(highest);
  return {fmt::format("{:.9g} to {:.9g}", 0.0, 1.0 - 0x1p-24), fmt::format("{:.9g} to {:.9g}", low, high), "exact",
          low == 0.0f && high == 1.0f - 0x1p-24f ? Verdict::pass : Verdict::fail, "all 2^32 words"};
}

// An image whose texel (x, y) is (x, y) in bytes, behind every wrap mode and filter; material k shows texture k.
Scene textured_scene() {
  constexpr std::uint32_t kSize = 64;
  Scene scene;
  Image& image = scene.images.emplace_back();
  image.width = image.height = kSize;
  for (std::uint32_t i = 0; i < kSize * kSize; ++i)
    for (const std::uint32_t byte : {4 * (i % kSize), 4 * (i / kSize), 0u, 255u})
      image.bytes.push_back(static_cast<std::uint8_t>(byte));
  for (const Wrap wrap : {Wrap::repeat, Wrap::clamp, Wrap::mirror})
    for (const bool nearest : {false, true}) {
      const std::uint32_t material = add_lambert(scene, glm::vec3(1.0f));
      scene.materials[material].base_color_texture = {.image = 0, .wrap_u = wrap, .wrap_v = wrap, .nearest = nearest};
      add_quad(scene, {0, 0, -float(material)}, {1, 0, 0}, {0, 1, 0}, material);
      constexpr float kNan = std::numeric_limits<float>::quiet_NaN(), kInf = std::numeric_limits<float>::infinity();
      scene.meshes.back().uvs[0] = {{0, 0}, {kNan, 0}, {1, 1}, {0, 0}, {1, kInf}, {0, -kInf}};
    }
  return scene;
}

Measurement texture_coordinates(const SelftestContext& context) {
  Scene source = textured_scene();
  TracedScene scene(context.device, context.kernels, pack(source));
  const auto texture_of = [&](const gpu::Triangle& triangle) {
    return scene.packed().materials[triangle.surface & gpu::kTriangleMaterialMask].base_color_texture;
  };
  // Extreme coordinates: any colour of the image is right. Then pairs that lie whole periods apart.
  constexpr float kInf = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kExtreme[] = {1e7f + 0.25f, -1e7f,   16777217.0f, 3e9f,  -3e9f, 1e20f, -3.4e38f,
                                1e-45f,       -1e-45f, 1.0f,        -0.0f, kNan,  kInf,  -kInf};
  std::vector<gpu::Ray> requests;
  for (const gpu::Triangle& triangle : scene.packed().triangles)
    for (const float u : kExtreme)
      for (const float v : {0.25f, u}) requests.push_back({{u, v, 0}, texture_of(triangle), {}, 0.0f});
  const std::size_t extremes = requests.size();
  Random random(41);
  for (const gpu::Triangle& triangle : scene.packed().triangles) {
    const std::uint32_t flags = scene.packed().textures[texture_of(triangle)].flags;
    if ((flags >> gpu::kTextureWrapUShift & 3u) == gpu::kWrapClamp || (flags & gpu::kTextureNearest)) continue;
    for (int i = 0; i < 1000; ++i) {
      const glm::vec2 uv(random.uniform(0.1f, 0.9f), random.uniform(0.1f, 0.9f)); // clear of the seam
      const float periods = 2.0f * std::floor(random.uniform(-5000, 5000));       // mirrored images repeat every two
      for (const float shift : {0.0f, periods})
        requests.push_back({{uv.x + shift, uv.y - shift, 0}, texture_of(triangle), {}, 0.0f});
    }
  }
  const std::vector<gpu::Hit> words = scene.run(wavepath_selftest_texture_spv, requests, 1);
  std::uint64_t outside = 0;
  double worst = 0.0; // texels
  const auto texel = [&](std::size_t i, int c) {
    return 63.75 * double{std::bit_cast<float>(c == 0 ? words[i].triangle : words[i].instance)};
  };
  for (std::size_t i = 0; i < words.size(); ++i)
    for (int c = 0; c < 2; ++c) {
      outside += !(texel(i, c) >= 0.0 && texel(i, c) <= 63.001);
      if (i >= extremes && (i - extremes) % 2 == 1) worst = std::max(worst, std::abs(texel(i, c) - texel(i - 1, c)));
    }
  std::uint64_t broken = 0; // left in the streams of vertices
  for (const glm::vec4& uv : scene.packed().vertex_uvs)
    for (int c = 0; c < 4; ++c) broken += !std::isfinite(uv[c]);
  return {"colours of the image, periods that agree",
          fmt::format("{} colours outside it, {} broken vertices kept, {:.3f} texels apart", outside, broken, worst),
          "0, 0, 1 texel (of 64) at 10^4 periods",
          outside + broken == 0 && worst <= 1.0 ? Verdict::pass : Verdict::fail,
          "coordinates to 3.4e38, infinite and not a number; repeated, mirrored, clamped; filtered and nearest"};
}

// Noise of an odd size behind every pair of wrap modes, filtered and not, as a colour and as values.
Scene noisy_scene() {
  constexpr std::uint32_t kWidth = 61, kHeight = 37;
  Scene scene;
  Image& image = scene.images.emplace_back();
  image.width = kWidth, image.height = kHeight;
  Random random(17);
  for (std::uint32_t i = 0; i < 4 * kWidth * kHeight; ++i)
    image.bytes.push_back(static_cast<std::uint8_t>(random.uniform(0.0f, 255.99f)));
  constexpr Wrap kWraps[] = {Wrap::repeat, Wrap::clamp, Wrap::mirror};
  for (int k = 0; k < 18; ++k) {
    const std::uint32_t material = add_lambert(scene, glm::vec3(1.0f));
    const TextureSlot slot{.image = 0, .wrap_u = kWraps[k % 3], .wrap_v = kWraps[k / 3 % 3], .nearest = k >= 9};
    scene.materials[material].base_color_texture = scene.materials[material].metallic_roughness_texture = slot;
    scene.materials[material].base_color_texture.srgb = true;
    add_quad(scene, {0, 0, -float(k)}, {1, 0, 0}, {0, 1, 0}, material);
    scene.meshes.back().uvs[0].assign(6, glm::vec2(0.0f));
  }
  return scene;
}

// Look-ups of all textures of a noisy scene at the same positions.
std::vector<float> look_up_noise(const SelftestContext& context, std::uint32_t textures, bool by_color) {
  RenderPlan settings;
  settings.textures = textures;
  Scene source = noisy_scene();
  TracedScene scene(context.device, context.kernels,
                    pack(source, {.samplers = sampler_limits(settings, context.device.info())}));
  Random random(23);
  std::vector<gpu::Ray> requests;
  for (int i = 0; i < 30000; ++i) {
    const gpu::Material& material = scene.packed().materials[std::size_t(i) % 18];
    const std::uint32_t texture = by_color ? material.base_color_texture : material.metallic_roughness_texture;
    requests.push_back(
        {{random.uniform(-2.0f, 3.0f), random.uniform(-2.0f, 3.0f), 0}, texture, {}, by_color ? 0.0f : -1.0f});
  }
  std::vector<float> values;
  for (const gpu::Hit& hit : scene.run(wavepath_selftest_texture_spv, requests, 1))
    values.insert(values.end(),
                  {std::bit_cast<float>(hit.triangle), std::bit_cast<float>(hit.instance), hit.b1, hit.b2});
  return values;
}

// Weights of 8 bits that are cut off miss by 1/256 of the contrast along each axis, and so may what the position in the
// image loses by rounding. What the average of 240,000 channels is off by shows a shift or another decoding; a driver
// that filters in 8 bits and cuts off what is beyond (llvmpipe with lanes of 512 bits) is up to half a step too dark.
constexpr double kSamplerError = 3.0 / 256.0, kSamplerBias = 0.5 / 255.0;

Measurement samplers(const SelftestContext& context) {
  double worst = 0.0, mean = 0.0;
  for (const bool by_color : {false, true}) {
    const std::vector<float> exact = look_up_noise(context, kTexturesExact, by_color),
                             found = look_up_noise(context, kTexturesHardware, by_color);
    for (std::size_t i = 0; i < exact.size(); ++i) {
      const double error = double{found[i]} - double{exact[i]};
      worst = std::max(worst, std::abs(error));
      mean += error / static_cast<double>(2 * exact.size());
    }
  }
  return {"what kernels find", fmt::format("{:.5f} apart, {:+.6f} on average", worst, mean), "3/256, 0.5/255",
          worst <= kSamplerError && std::abs(mean) <= kSamplerBias ? Verdict::pass : Verdict::fail,
          "noise of full contrast, as colours and as values, in every wrap mode, filtered and nearest"};
}

// Three lamps of these radiances on a wall, above a floor whose middle has the albedo `dark`.
Scene dim_room(const std::array<float, 3>& emission, float dark) {
  Scene scene;
  for (int i = 0; i < 3; ++i) {
    const float x = static_cast<float>(2 * i - 3);
    add_quad(scene, {x, -1, 0}, {2, 0, 0}, {0, 2, 0},
             add_lambert(scene, glm::vec3(0.5f), glm::vec3(emission[std::size_t(i)])));
    add_quad(scene, {x, -1, 2}, {2, 0, 0}, {0, 0, -2}, add_lambert(scene, glm::vec3(i == 1 ? dark : 0.5f)));
  }
  look_at(scene, {0, 1, 6}, {0, -0.2, 0}, 0.7);
  return scene;
}

// How a picture compares with one of the same paths under lamps that are 1 / `scale` as bright. A device may flush
// denormal terms to zero, so nothing is too dark there; elsewhere all of the light must come through.
struct DimComparison {
  std::uint64_t broken = 0; // negative, not a number, or brighter than it should be
  double worst = 0.0;       // error of a pixel over the brightest pixel
};
DimComparison compare_dim(const Picture& dim, const Picture& bright, double scale) {
  constexpr double kRounding = 1e-5, kSmallest = 16 * 0x1p-149; // relative; and of up to that many denormal terms
  DimComparison result;
  for (std::size_t c = 0; c < 3; ++c) {
    const std::vector<float>&found = dim.channels[c].values, &expected = bright.channels[c].values;
    const double brightest = *std::ranges::max_element(expected);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const double value = found[i], right = expected[i] * scale;
      result.broken += !(value >= 0.0 && value <= right * (1.0 + kRounding) + kSmallest);
      result.worst = std::max(result.worst, std::abs(value - right) / (brightest * scale));
    }
  }
  return result;
}

// Lamps of 10^-39 to 10^-45 over a floor, some of it so dark that paths carry as little: no pixel is brighter than it
// should be, and the paths are as many as with lamps of 1. And lamps of 2^-100, which no path of eight bounces takes
// down to denormal numbers: their picture is that of lamps of 1, scaled. The estimator is --direct bsdf, whose choices
// do not depend on how bright the lamps are, so that the pictures that are compared are of the same paths.
Measurement denormals(const SelftestContext& context) {
  constexpr float kUp = 0x1p100f;
  const auto trial = [&](const std::array<float, 3>& emission, float dark, std::uint32_t direct) {
    RenderPlan settings;
    settings.width = settings.height = 32;
    settings.last_sample = 16;
    settings.direct = direct;
    return render_scene(context.device, dim_room(emission, dark), settings);
  };
  const std::array<float, 3> tiny{1e-39f, 1e-42f, 1e-45f};
  const auto plain = trial({1.0f, 1.0f, 1.0f}, 0.5f, gpu::kDirectBsdf),
             dim = trial({1.0f / kUp, 1.0f / kUp, 1.0f / kUp}, 0.5f, gpu::kDirectBsdf),
             darkest = trial(tiny, 1e-40f, gpu::kDirectBsdf),
             raised = trial({tiny[0] * kUp, tiny[1] * kUp, tiny[2] * kUp}, 1e-40f, gpu::kDirectBsdf),
             by_all_means = trial(tiny, 1e-40f, gpu::kDirectMis);
  const DimComparison normal = compare_dim(dim.picture, plain.picture, 1.0 / double{kUp});
  const DimComparison denormal = compare_dim(darkest.picture, raised.picture, 1.0 / double{kUp});
  std::uint64_t broken = normal.broken + denormal.broken;
  for (const RenderResult* result : {&plain, &dim, &darkest, &raised, &by_all_means})
    broken += result->nonfinite.samples();
  for (std::size_t c = 0; c < 3; ++c)
    for (const float value : by_all_means.picture.channels[c].values)
      broken += !(value >= 0.0f && value <= 2.02f * tiny[0]); // nothing outshines emission / (1 - albedo)
  const double brightest = *std::ranges::max_element(plain.picture.channels[0].values);
  const double ratio = static_cast<double>(std::max(darkest.rays.total(), by_all_means.rays.total())) /
                       static_cast<double>(plain.rays.total());
  const bool good = broken == 0 && ratio <= 2.0 && normal.worst <= 1e-5 && brightest >= 1.0;
  return {
      "0 broken values, no more rays, no light lost at 2^-100",
      fmt::format("{} broken, {:.2f} times the rays, off by {:.2g}", broken, ratio, normal.worst), "0, 2 times, 1e-5",
      good ? Verdict::pass : Verdict::fail,
      fmt::format("radiance of 2^-100, and of 10^-39 to 10^-45 with an albedo of 10^-40, off by {:.2g}, where a device "
                  "may make it zero; that took {:.2f} times as long as radiance of 1",
                  denormal.worst, darkest.seconds / plain.seconds)};
}

// A 16-bit EXR with normals, depths to 10^6 and colours to 10^6, read back.
Measurement half_pictures(const SelftestContext&) {
  constexpr std::uint32_t kSize = 64;
  Picture picture{kSize, kSize, {}};
  for (const char* name : {"R", "G", "B", "A", "N.X", "N.Y", "N.Z", "Z"}) picture.channels.push_back({name, {}});
  Random random(37);
  std::uint64_t too_bright = 0;
  for (std::uint32_t i = 0; i < kSize * kSize; ++i) {
    const glm::vec3 normal = random.direction();
    const float radiance = random.log_uniform(-6, 6);
    too_bright += 3 * (radiance > 65504.0f);
    const float values[] = {radiance, radiance, radiance, 1.0f,
                            normal.x, normal.y, normal.z, random.log_uniform(-6, 6)};
    for (std::size_t c = 0; c < std::size(values); ++c) picture.channels[c].values.push_back(values[c]);
  }
  std::string folder = (std::filesystem::temp_directory_path() / "wavepath-selftest-XXXXXX").string();
  if (!mkdtemp(folder.data()))
    return {"a picture", "none", "", Verdict::skip,
            "no temporary folder can be made; set TMPDIR to one that can be written"};
  const std::string path = folder + "/half.exr";
  const std::uint64_t clamped = write_picture(path, picture, {}, {.half = true});
  const Picture back = read_picture(path);
  std::filesystem::remove_all(folder);

  double worst_normal = 0.0, worst_depth = 0.0;
  std::uint64_t infinite = 0;
  for (const Channel& channel : picture.channels) {
    const Channel& read = *find_channel(back, channel.name);
    for (std::size_t i = 0; i < read.values.size(); ++i) {
      infinite += !std::isfinite(read.values[i]);
      const double error = std::abs(double{read.values[i]} - double{channel.values[i]});
      if (channel.name[0] == 'N') worst_normal = std::max(worst_normal, error);
      if (channel.name == "Z") worst_depth = std::max(worst_depth, error);
    }
  }
  const bool good = infinite == 0 && clamped == too_bright && worst_normal < 1e-3 && worst_depth == 0.0;
  return {"no infinity, clamped values counted",
          fmt::format("{} infinite, {} of {} counted, normals off by {:.2g}, depths by {:.2g}", infinite, clamped,
                      too_bright, worst_normal, worst_depth),
          "0, exact, 1e-3, 0", good ? Verdict::pass : Verdict::fail,
          "on the device all values are 32-bit; only --half makes 16-bit ones, and keeps depth and position at 32"};
}

constexpr SelftestCase kNumberCases[] = {
    {37, "16-bit pictures", "bright pixels and far depths turn infinite in 16-bit files", half_pictures},
    {38, "denormal radiance and throughput", "very dark scenes render slowly or turn black in patches", denormals},
    {40, "random numbers lie in [0, 1)", "rare samples fall outside of lights and pixels, as fireflies", unit_interval},
    {41, "texture coordinates far out", "textures that repeat often smear, broken ones turn pixels black",
     texture_coordinates},
    {0, "samplers find what kernels find", "textures are blurred, shifted or off in colour with --textures hardware",
     samplers},
};

} // namespace

std::span<const SelftestCase> number_cases() { return kNumberCases; }

} // namespace wavepath
