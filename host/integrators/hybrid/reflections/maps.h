// Reflections by a map of what is seen around one point, rendered anew for every frame.
#pragma once

#include <limits>

#include "host/integrators/hybrid/raster/slices.h"
#include "host/integrators/hybrid/reflections/reflections.h"

namespace wavepath {

extern const KernelProgram kMapProgram;

class MapReflections : public Reflections {
public:
  struct Box { // device world
    glm::dvec3 low{std::numeric_limits<double>::infinity()}, high{-std::numeric_limits<double>::infinity()};
    bool is_empty() const { return !(low.x <= high.x); }
    glm::dvec3 middle() const { return 0.5 * (low + high); }
  };

  // `map_kind`: a kMap constant.
  MapReflections(const ReflectionContext& context, std::uint32_t map_kind);

  void change(const View& view, const RenderPlan& settings, const KernelConfig& config,
              const std::vector<Binding>& shared) override;
  void build(WaveQueue& queue) override;
  void finish(WaveQueue& queue) override;
  std::uint64_t bytes() const override { return Reflections::bytes() + map_.bytes(); }

protected:
  void add_bindings(std::vector<Binding>& bindings) override {
    bindings.push_back({gpu::kBindReflectionMap, BindingKind::storage, &map_});
  }

private:
  void record_texels(Commands& commands, const gpu::Wave& wave);

  Box whole_, mirrors_;     // boxes around the scene, and around its mirrors
  double threshold_ = -1.0; // by which surfaces are mirrors_
  std::uint32_t texels_ = 0;
  Buffer map_;
  SliceLength texels_a_slice_, pixels_a_slice_;
};

} // namespace wavepath
