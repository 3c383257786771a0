// What the kernel `shade` takes for a path of the Cornell box, and what the same work takes in C++ on this processor
// (shade_lanes.h): one path at a time, 8 and 16 in vectors, and 8 with stores as Mesa's driver makes them, or none.
//
// The device traces a wave of paths until shade of a bounce would come. Kernel and C++ shade that wave, and what they
// make of it is compared before anything is measured. With --benchmark_enable_random_interleaving=true they take turns;
// with LP_NUM_THREADS=0 in the environment llvmpipe keeps to one thread.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>

#include "benchmarks/shade_lanes.h"
#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/gpu/commands.h"
#include "host/gpu/device.h"
#include "host/integrators/path/paths.h"
#include "host/render/settings/traversal.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"
#include "host/scene/staging/view.h"

namespace wavepath {
namespace {

constexpr std::uint32_t kWidth = 512, kHeight = 256, kPaths = kWidth * kHeight;

// ---- the kernel -----------------------------------------------------------------------------------------------------

struct Shaded {
  std::vector<gpu::PathState> paths;
  std::vector<gpu::Ray> rays; // in any order, as shadow rays are
  std::vector<gpu::ShadowRay> shadow_rays;
};

class ShadeKernel {
public:
  explicit ShadeKernel(const std::filesystem::path& path) {
    Scene scene = load_gltf(path);
    RenderPlan settings;
    settings.width = kWidth;
    settings.height = kHeight;
    settings.max_depth = 5;
    const View view = resolve_view(scene, {}, kWidth, kHeight);
    packed_ = pack(scene, {.eye = view.position});
    constexpr gpu::Feature kKnown = gpu::kFeatureEmission | gpu::kFeatureTriangleLights | gpu::kFeatureCull;
    if (packed_.features & ~kKnown)
      throw Error(path.string(), "has more than shade_lanes.h knows", "name the Cornell box");
    workspace_ = std::make_unique<Workspace>(device_, packed_, kPaths, traversal_of(settings));
    paths_ = std::make_unique<Paths>(*workspace_, compiler_);
    workspace_->change(view, settings);
    paths_->change(settings, kAllPathStages, 0);
    paths_->get_ready();
  }

  // The first sample of every pixel when it comes to shade of this bounce.
  ShadeInput trace(std::uint32_t bounce) {
    ShadeInput in{.frame = workspace_->frame, .wave = {0, kPaths, 0, 1, bounce, 0}};
    const KernelSet& kernels = paths_->kernels();
    commands_.restart(0);
    commands_.bind(paths_->bindings(0));
    commands_.dispatch(kernels[kGenerate], groups_for(kPaths), &in.wave);
    for (std::uint32_t b = 0; b < bounce; ++b) {
      paths_->extend(commands_, kernels, in.wave, b);
      paths_->shade(commands_, kernels, kernels, in.wave, b);
      paths_->connect(commands_, kernels, in.wave, b);
    }
    paths_->extend(commands_, kernels, in.wave, bounce);
    commands_.submit_and_wait();
    const gpu::Queues queues = this->queues();
    in.rays = download<gpu::Ray>(paths_->buffers[kRays], queues.ray_count[bounce & 1], queue_of(bounce));
    in.hits = download<gpu::Hit>(paths_->buffers[kHits], in.rays.size());
    in.sorted_rays = download<std::uint32_t>(paths_->buffers[kSortedRays], queues.hit_count);
    in.paths = download<gpu::PathState>(paths_->buffers[kStates], kPaths);
    in.triangles = packed_.triangles;
    in.materials = packed_.materials;
    in.lights = packed_.lights;
    return in;
  }

  // Seconds that it takes.
  double shade(const ShadeInput& in) {
    gpu::Queues queues{};
    queues.hit_count = static_cast<std::uint32_t>(in.sorted_rays.size());
    paths_->buffers[kRays].write(in.rays.data(), in.rays.size() * sizeof(gpu::Ray), queue_of(in.wave.bounce));
    paths_->buffers[kHits].write(in.hits.data(), in.hits.size() * sizeof(gpu::Hit));
    paths_->buffers[kSortedRays].write(in.sorted_rays.data(), in.sorted_rays.size() * sizeof(std::uint32_t));
    paths_->buffers[kStates].write(in.paths.data(), in.paths.size() * sizeof(gpu::PathState));
    commands_.restart(1);
    commands_.write(paths_->buffers[kQueues], &queues, sizeof(queues));
    commands_.bind(paths_->bindings(0));
    commands_.dispatch(paths_->kernels()[kShade], groups_for(in.sorted_rays.size()), &in.wave);
    const Clock::time_point start = Clock::now();
    commands_.submit_and_wait();
    return commands_.times().empty() ? seconds_since(start) : commands_.times().front().seconds;
  }

  Shaded shaded(std::uint32_t bounce) const {
    const gpu::Queues counts = queues();
    return {download<gpu::PathState>(paths_->buffers[kStates], kPaths),
            download<gpu::Ray>(paths_->buffers[kRays], counts.ray_count[~bounce & 1], queue_of(bounce + 1)),
            download<gpu::ShadowRay>(paths_->buffers[kShadowRays], counts.shadow_count[0])};
  }

private:
  gpu::Queues queues() const { return download<gpu::Queues>(paths_->buffers[kQueues], 1).front(); }
  static std::uint64_t queue_of(std::uint32_t bounce) { return (bounce & 1) * kPaths * sizeof(gpu::Ray); }

  PackedScene packed_;
  Device device_;
  KernelCompiler compiler_{device_};
  std::unique_ptr<Workspace> workspace_;
  std::unique_ptr<Paths> paths_;
  Commands commands_{device_};
};

// ---- the same in C++ ------------------------------------------------------------------------------------------------

// Seconds that it takes on one or two threads, each with a run of the paths as llvmpipe deals them.
template <int W, Stores kStores = Stores::rows>
double shade(const ShadeInput& in, ShadeOutput& out, int threads) {
  out.paths = in.paths;
  out.paths.emplace_back();
  out.rays.resize(kPaths + 1);
  out.shadow_rays.resize(kPaths + 1);
  out.ray_count = out.shadow_count = 0;
  const auto count = static_cast<std::uint32_t>(in.sorted_rays.size());
  const std::uint32_t middle = threads == 1 ? count : count / 2 / W * W;
  const auto run = [&](std::uint32_t first, std::uint32_t end) { ShadeLanes<W, kStores>(in, out).shade(first, end); };
  const Clock::time_point start = Clock::now();
  std::jthread second;
  if (threads == 2) second = std::jthread(run, middle, count);
  run(0, middle);
  if (threads == 2) second.join();
  return seconds_since(start);
}

using Version = double (*)(const ShadeInput&, ShadeOutput&, int threads);
struct NamedVersion {
  const char* name;
  Version shade;
  bool stores = true;
};
constexpr NamedVersion kVersions[] = {{"lanes:1", shade<1>},
                                      {"lanes:8", shade<8>},
                                      {"lanes:16", shade<16>},
                                      {"lanes:8/stores:words", shade<8, Stores::words>},
                                      {"lanes:8/stores:none", shade<8, Stores::none>, false}};

// ---- comparison -----------------------------------------------------------------------------------------------------

template <class Record>
std::vector<Record> by_slot(std::vector<Record> records) {
  std::ranges::sort(records, {}, &Record::slot);
  return records;
}

// Prints how many words of the records have the kernel's bits, and how far the others are from it.
template <class Record>
void compare(const char* what, const std::vector<Record>& ours, const std::vector<Record>& theirs) {
  const std::size_t words = std::min(ours.size(), theirs.size()) * sizeof(Record) / 4;
  std::size_t same = 0;
  float furthest = 0.0f;
  for (std::size_t i = 0; i < words; ++i) {
    float a, b;
    std::memcpy(&a, reinterpret_cast<const char*>(ours.data()) + 4 * i, 4);
    std::memcpy(&b, reinterpret_cast<const char*>(theirs.data()) + 4 * i, 4);
    if (std::memcmp(&a, &b, 4) == 0)
      ++same;
    else
      furthest = std::max(furthest, std::abs(a - b));
  }
  std::printf("  %zu %s (kernel %zu): %zu of %zu words the same, others within %g\n", ours.size(), what, theirs.size(),
              same, words, static_cast<double>(furthest));
}

void compare(const char* name, const ShadeOutput& ours, const Shaded& theirs) {
  std::printf("%s\n", name);
  compare("paths", std::vector(ours.paths.begin(), ours.paths.end() - 1), theirs.paths);
  compare("rays", by_slot(std::vector(ours.rays.begin(), ours.rays.begin() + ours.ray_count)), by_slot(theirs.rays));
  compare("shadow rays", by_slot(std::vector(ours.shadow_rays.begin(), ours.shadow_rays.begin() + ours.shadow_count)),
          by_slot(theirs.shadow_rays));
}

// ---- measurement ----------------------------------------------------------------------------------------------------

template <class Measure>
void add(const std::string& name, std::size_t paths, const Measure& measure) {
  const auto body = [=](benchmark::State& state) {
    double seconds = 0.0;
    for (auto _ : state) {
      const double taken = measure();
      state.SetIterationTime(taken);
      seconds += taken;
    }
    const double shaded = static_cast<double>(state.iterations()) * static_cast<double>(paths);
    state.counters["ns/path"] = 1e9 * seconds / shaded;
  };
  benchmark::RegisterBenchmark(name.c_str(), body)->Unit(benchmark::kMillisecond)->UseManualTime();
}

void add_bounce(ShadeKernel& kernel, const ShadeInput& in, ShadeOutput& out) {
  const std::size_t paths = in.sorted_rays.size();
  const std::string bounce = "bounce:" + std::to_string(in.wave.bounce) + "/";
  kernel.shade(in);
  const Shaded shaded = kernel.shaded(in.wave.bounce);
  add(bounce + "kernel", paths, [&] { return kernel.shade(in); });
  for (const NamedVersion& version : kVersions) {
    version.shade(in, out, 1);
    if (version.stores) compare((bounce + version.name).c_str(), out, shaded);
    for (const int threads : {1, 2})
      add(bounce + version.name + "/threads:" + std::to_string(threads), paths,
          [&, threads] { return version.shade(in, out, threads); });
  }
}

} // namespace
} // namespace wavepath

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  wavepath::ShadeKernel kernel(std::filesystem::path(WAVEPATH_SOURCE_DIR) / "scenes/cornell_box.gltf");
  const wavepath::ShadeInput second = kernel.trace(1), third = kernel.trace(2); // the third has Russian roulette
  wavepath::ShadeOutput out;
  wavepath::add_bounce(kernel, second, out);
  wavepath::add_bounce(kernel, third, out);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
