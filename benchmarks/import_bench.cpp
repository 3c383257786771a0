// How fast scenes are loaded and packed for the device, in triangles and texels per second: those of scenes/ and of
// ../shared/scenes where that folder is there.
#include <filesystem>
#include <string>

#include <benchmark/benchmark.h>

#include "host/scene/gltf/gltf.h"
#include "host/scene/pack/pack.h"

namespace wavepath {
namespace {

const std::filesystem::path kSource = WAVEPATH_SOURCE_DIR;

bool found(benchmark::State& state, const std::filesystem::path& path) {
  if (std::filesystem::exists(path)) return true;
  state.SkipWithError((path.string() + " is not there").c_str());
  return false;
}

// Reads and decodes the file: geometry, tangents, images.
void load(benchmark::State& state, const std::filesystem::path& path) {
  if (!found(state, path)) return;
  std::size_t triangles = 0, texels = 0;
  for (auto _ : state) {
    const Scene scene = load_gltf(path);
    triangles = texels = 0;
    for (const Mesh& mesh : scene.meshes) triangles += mesh.indices.size() / 3;
    for (const Image& image : scene.images) texels += std::size_t{image.width} * image.height;
  }
  using benchmark::Counter;
  state.counters["triangles"] = static_cast<double>(triangles);
  state.counters["triangles/s"] = Counter(static_cast<double>(triangles), Counter::kIsIterationInvariantRate);
  state.counters["texels/s"] = Counter(static_cast<double>(texels), Counter::kIsIterationInvariantRate);
}

// Lays a loaded scene out for the device, the BVH included.
void lay_out(benchmark::State& state, const std::filesystem::path& path) {
  if (!found(state, path)) return;
  Scene scene = load_gltf(path);
  std::size_t triangles = 0;
  for (auto _ : state) triangles = pack(scene).triangles_stored;
  state.counters["triangles"] = static_cast<double>(triangles);
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(triangles));
}

void add(const std::string& name, const std::filesystem::path& path) {
  benchmark::RegisterBenchmark(("load/" + name).c_str(), load, path)->Unit(benchmark::kMillisecond)->UseRealTime();
  benchmark::RegisterBenchmark(("pack/" + name).c_str(), lay_out, path)->Unit(benchmark::kMillisecond)->UseRealTime();
}

} // namespace
} // namespace wavepath

int main(int argc, char** argv) {
  for (const char* name : {"cornell_box.gltf", "showcase.glb"})
    wavepath::add(name, wavepath::kSource / "scenes" / name);
  for (const char* name :
       {"DamagedHelmet/glTF-Binary/DamagedHelmet.glb", "Sponza/Sponza.gltf", "FlightHelmet/FlightHelmet.gltf",
        "StanfordDragon/dragon-plain.glb", "StanfordDragon/dragon-draco.gltf", "HotelRoom/HotelRoom-meshopt.glb"})
    wavepath::add(name, wavepath::kSource / "../shared/scenes" / name);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
