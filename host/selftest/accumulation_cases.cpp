// Cases of sums: means of very many samples, arithmetic that must stay as written, sample numbers near the end.
#include <algorithm>
#include <bit>
#include <cmath>
#include <set>

#include <fmt/format.h>

#include "host/film/film.h"
#include "host/gpu/commands.h"
#include "host/selftest/scenes.h"
#include "host/selftest/selftest.h"
#include "host/selftest/shapes.h"
#include "host/selftest/studio.h"
#include "host/selftest/traced_scene.h"
#include "kernels/path/accumulate.spv.h"
#include "kernels/selftest/selftest_precise.spv.h"
#include "kernels/selftest/selftest_sampler.spv.h"

namespace wavepath {
namespace {

// Runs a kernel over requests at binding 0; returns the results at binding 1.
template <class Result, class Request>
std::vector<Result> run_probe(Device& device, std::span<const std::uint32_t> spirv,
                              const std::vector<Request>& requests, std::span<const std::uint32_t> constants = {}) {
  const Buffer in = upload(device, requests), out(device, requests.size() * sizeof(Result));
  const Binding all[] = {{0, BindingKind::storage, &in}, {1, BindingKind::storage, &out}};
  const BindingSet bindings(device, all, sizeof(std::uint32_t));
  const Kernel kernel(device, "probe", spirv, bindings, constants);
  const auto count = static_cast<std::uint32_t>(requests.size());
  Commands commands(device);
  commands.bind(bindings);
  commands.dispatch(kernel, (count + gpu::kWorkgroupSize - 1) / gpu::kWorkgroupSize, &count);
  commands.submit_and_wait();
  return download<Result>(out, requests.size());
}

// The film of a row of pixels to which accumulate.comp adds paths that are given.
class FilmBench {
public:
  static constexpr std::uint32_t kPixels = 16;

  // Slot = sample * kPixels + pixel.
  FilmBench(const SelftestContext& context, const std::vector<gpu::PathState>& paths)
      : context_(context),
        samples_(static_cast<std::uint32_t>(paths.size()) / kPixels),
        frame_(context.device, sizeof(gpu::Frame)),
        states_(upload(context.device, paths)),
        queues_(context.device, sizeof(gpu::Queues)),
        film_(context.device, kPixels * gpu::kReplicates * sizeof(gpu::FilmPixel)),
        unused_(context.device, 0),
        bindings_(bind_path_tracer(context.device,
                                   std::vector<Binding>{{gpu::kBindFrame, BindingKind::uniform, &frame_},
                                                        {gpu::kBindPaths, BindingKind::storage, &states_},
                                                        {gpu::kBindPathTexels, BindingKind::texels_rgba32f, &states_},
                                                        {gpu::kBindQueues, BindingKind::storage, &queues_},
                                                        {gpu::kBindFilm, BindingKind::storage, &film_},
                                                        {gpu::kBindFilmTexels, BindingKind::texels_rgba32ui, &film_}},
                                   unused_)) {
    gpu::Frame frame{};
    frame.width = frame.film_width = kPixels, frame.height = frame.film_height = 1;
    frame_.write(&frame, sizeof(frame));
    queues_.fill_zero();
    film_.fill_zero();
  }

  // Adds all samples of every pixel that many times, as waves of a render.
  Film add(std::uint32_t times) {
    constexpr std::uint32_t kAtOnce = 32; // waves a submission: a few hundredths of a second on a slow CPU
    const Kernel& kernel = context_.kernels.get(wavepath_accumulate_spv, 0, 1, *bindings_);
    for (std::uint32_t first = 0; first < times; first += kAtOnce) {
      Commands commands(context_.device);
      commands.bind(*bindings_);
      for (std::uint32_t i = first; i < std::min(first + kAtOnce, times); ++i) {
        const gpu::Wave wave{0, kPixels, i * samples_, samples_, 0, 0};
        commands.dispatch(kernel, 1, &wave);
        commands.barrier();
      }
      commands.submit_and_wait();
    }
    return {kPixels, 1, download<gpu::FilmPixel>(film_, kPixels * gpu::kReplicates), {}};
  }

private:
  SelftestContext context_;
  std::uint32_t samples_;
  Buffer frame_, states_, queues_, film_, unused_;
  std::unique_ptr<BindingSet> bindings_;
};

// Red: 0.1, which no float is. Green: exponentially distributed. Blue: a thousandth, and ten thousand once in a while.
Measurement many_samples(const SelftestContext& context) {
  constexpr std::uint32_t kSamples = 1024; // their states fit into the smallest texel buffers
  Random random(35);
  std::vector<gpu::PathState> paths(kSamples * FilmBench::kPixels);
  std::vector<glm::dvec3> expected(FilmBench::kPixels);
  for (std::uint32_t i = 0; i < paths.size(); ++i) {
    paths[i].radiance = {0.1f, -std::log(1.0f - random.uniform()), random.below(kSamples) ? 1e-3f : 1e4f};
    expected[i % FilmBench::kPixels] += glm::dvec3(paths[i].radiance) / double{kSamples};
  }
  const std::uint32_t times = context.full ? 9766 : 978;
  const Film film = FilmBench(context, paths).add(times);
  double worst = 0.0;
  std::uint64_t lost = 0;
  for (std::size_t pixel = 0; pixel < FilmBench::kPixels; ++pixel) {
    lost += sample_count(film, pixel) != times * kSamples;
    const glm::vec3 mean(mean_radiance(film, pixel));
    for (int c = 0; c < 3; ++c) worst = std::max(worst, std::abs(double{mean[c]} / expected[pixel][c] - 1.0));
  }
  Measurement result =
      judge_near(worst, 0.0, 2e-6, fmt::format("worst relative error of a mean over {} samples", times * kSamples));
  if (lost > 0) result.verdict = Verdict::fail, result.note += fmt::format("; {} pixels lost samples", lost);
  return result;
}

// The film's sum of [2^24, 1, -2^24]; and `precise` sums and edge functions on their own.
Measurement precise_arithmetic(const SelftestContext& context) {
  std::vector<gpu::PathState> paths(3 * FilmBench::kPixels);
  for (std::uint32_t i = 0; i < paths.size(); ++i) {
    constexpr float kValues[] = {0x1p24f, 1.0f, -0x1p24f};
    paths[i].radiance = glm::vec3(kValues[i / FilmBench::kPixels]);
  }
  const float mean = static_cast<float>(mean_radiance(FilmBench(context, paths).add(1), 0).x);

  Random random(36);
  std::vector<glm::vec4> inputs = {{0x1p24f, 1.0f, 3.0f, 7.0f}};
  for (int i = 1; i < 100'000; ++i) {
    const float large = random.log_uniform(4, 8) * (i % 2 ? 1.0f : -1.0f);
    inputs.emplace_back(large, random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1e-4f, 1e-4f));
  }
  std::uint64_t sums = 0, edges = 0;
  const auto results = run_probe<glm::vec4>(context.device, wavepath_selftest_precise_spv, inputs);
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    sums += results[i].x != inputs[i].y;
    edges += results[i].y != -results[i].z;
  }
  return {fmt::format("{:.8g}; all kept", 1.0f / 3.0f),
          fmt::format("{:.8g}; {} sums and {} edge functions of {} changed", mean, sums, edges, inputs.size()), "exact",
          mean == 1.0f / 3.0f && sums + edges == 0 ? Verdict::pass : Verdict::fail,
          "mean of 2^24, 1, -2^24 by the film; compensated sums and edge functions as written with `precise`"};
}

// Samples next to 2^31 and 2^32, where signed and unsigned counts end: each has numbers of its own, and pictures of
// them have the mean of those from sample 0 on.
Measurement last_samples(const SelftestContext& context) {
  std::vector<std::uint32_t> samples;
  for (std::uint32_t i = 0; i < 128; ++i)
    for (const std::uint32_t first : {0u, 0x7fffffc0u, 0xffffff80u}) samples.push_back(first + i);
  constexpr std::uint32_t kPixels = 256;
  std::vector<glm::uvec2> requests;
  for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel)
    for (const std::uint32_t sample : samples) requests.emplace_back(pixel, sample);
  std::uint64_t repeated = 0;
  double worst = 0.0; // deviation of a mean in standard errors
  for (const std::uint32_t sampler : {gpu::kSamplerIndependent, gpu::kSamplerStratified, gpu::kSamplerSobol}) {
    std::array<std::uint32_t, gpu::kSpecCount> constants{};
    constants[gpu::kSpecSampler] = sampler;
    const auto points = run_probe<glm::vec2>(context.device, wavepath_selftest_sampler_spv, requests, constants);
    for (std::uint32_t pixel = 0; pixel < kPixels; ++pixel) {
      std::set<std::uint64_t> seen;
      for (std::size_t i = 0; i < samples.size(); ++i) {
        const glm::vec2 p = points[pixel * samples.size() + i];
        repeated +=
            !seen.insert(std::uint64_t{std::bit_cast<std::uint32_t>(p.x)} << 32 | std::bit_cast<std::uint32_t>(p.y))
                 .second;
      }
    }
    glm::dvec2 mean(0.0);
    for (const glm::vec2& p : points) mean += glm::dvec2(p) / static_cast<double>(points.size());
    const double error = std::sqrt(1.0 / 12.0 / static_cast<double>(points.size()));
    worst = std::max({worst, std::abs(mean.x - 0.5) / error, std::abs(mean.y - 0.5) / error});
  }

  Scene scene; // a floor under a lamp
  add_quad(scene, {-2, 0, 2}, {4, 0, 0}, {0, 0, -4}, add_lambert(scene, glm::vec3(0.5f)));
  add_quad(scene, {-0.5f, 1, -0.5f}, {1, 0, 0}, {0, 0, 1}, add_lambert(scene, glm::vec3(0.5f), glm::vec3(1.0f)));
  look_at(scene, {0, 2, 4}, {0, 0, 0}, 0.6);
  RenderPlan settings;
  settings.width = settings.height = 32;
  settings.sampler = gpu::kSamplerIndependent;
  std::vector<std::vector<float>> pictures;
  std::uint64_t broken = 0;
  for (const std::uint32_t first : {0u, 0x7fffffc0u, 0xffffff7fu}) { // the last sample there is: 2^32 - 2
    settings.first_sample = first, settings.last_sample = first + 128;
    const RenderResult result = render_scene(context.device, scene, settings);
    broken += result.spp != 128 || result.nonfinite.first.has_value();
    pictures.push_back(result.picture.channels[0].values);
  }
  // A range whose next power of two is beyond the last sample. A loop that runs past 2^32 begins again at 0, so that
  // there is a limit of time.
  settings.first_sample = 0xfffffff5, settings.last_sample = 0xffffffff, settings.time_limit = 60.0;
  broken += render_scene(context.device, scene, settings).spp != 10;
  double noise = 0.0; // standard error of a difference over the mean
  for (std::size_t k = 1; k < pictures.size(); ++k) {
    double sum = 0.0, squares = 0.0, total = 0.0;
    const std::size_t n = pictures[0].size();
    for (std::size_t i = 0; i < n; ++i) {
      total += double{pictures[0][i]};
      const double difference = double{pictures[k][i]} - double{pictures[0][i]};
      sum += difference, squares += difference * difference;
    }
    broken += squares == 0.0; // the same numbers again
    noise = std::max(noise, std::sqrt(squares) / total);
    worst = std::max(worst, std::abs(sum) / std::sqrt(squares));
  }
  return {"numbers of their own, unbiased",
          fmt::format("{} repeated, {} pictures broken, means within {:.2f} standard errors of {:.2g}", repeated,
                      broken, worst, noise),
          fmt::format("0, 0, 3 standard errors of {}", kLargestNoise),
          repeated + broken == 0 && worst <= 3.0 && noise <= kLargestNoise ? Verdict::pass : Verdict::fail,
          "128 samples from 2^31 - 64 and up to the last, 2^32 - 2, beyond which no range can be asked for; three "
          "samplers"};
}

constexpr SelftestCase kAccumulationCases[] = {
    {35, "mean of very many samples", "long renders drift in brightness", many_samples},
    {36, "precise arithmetic survives the driver", "long renders lose light and meshes leak: the driver reorders sums",
     precise_arithmetic},
    {39, "samples near 2^31 and 2^32", "parts of a render farm's picture repeat the same noise", last_samples},
};

} // namespace

std::span<const SelftestCase> accumulation_cases() { return kAccumulationCases; }

} // namespace wavepath
