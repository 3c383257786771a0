// `wavepath bench --kernels`: what a driver's compiler tells of every kernel. Needs no memory of the device, so that a
// driver without its hardware serves as well.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/gpu/device.h"
#include "host/gpu/kernel_statistics.h"
#include "host/render/settings/render_plan.h"
#include "host/scene/pack/packed_scene.h"

namespace wavepath {

struct CompiledKernel {
  std::string kernel, configuration; // "extend"; "path", "path, generic", "hybrid, shadows pcf"
  std::vector<KernelStatistic> statistics;
};

// Compute kernels of every integrator for this scene, generic ones, and those of techniques of hybrid frames; not those
// that trace first hits or filter frames. A set is listed where it is first asked for. `ablate`: those of path tracing
// with each feature as well that the scene leaves out. The device was opened for DeviceUse::compile. `progress` is told
// what comes next.
std::vector<CompiledKernel> compile_kernels(Device& device, const PackedScene& scene, const RenderPlan& settings,
                                            bool ablate, const std::function<void(const std::string&)>& progress);

// [{"kernel", "configuration", "device", "statistics": {name: value}}]
nlohmann::ordered_json compiled_document(const DeviceInfo& device, const std::vector<CompiledKernel>& kernels);

// Registers, spills, occupancy and size of code, for a terminal.
std::string compiled_table(const DeviceInfo& device, const std::vector<CompiledKernel>& kernels);

} // namespace wavepath
