// Preparation of a render: opens the devices, packs the scene, makes the plan.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/base/warnings.h"
#include "host/gpu/device.h"
#include "host/passes/motion.h"
#include "host/picture/tev.h"
#include "host/plan/memory.h"
#include "host/plan/plan.h"
#include "host/render/render.h"
#include "host/render/workspace/kernel_compiler.h"
#include "host/scene/pack/pack.h"
#include "host/scene/pack/pack_memory.h"
#include "host/session/load.h"
#include "host/session/motion_request.h"
#include "host/session/open_scene.h"
#include "host/session/requests.h"

namespace wavepath {

// A device of --devices other than the first.
struct OtherDevice {
  std::unique_ptr<Device> device;
  std::unique_ptr<KernelCompiler> kernels;
};

struct Prepared {
  std::shared_ptr<Device> device;
  std::shared_ptr<KernelCompiler> kernels;
  std::vector<OtherDevice> others;
  std::unique_ptr<TevViewer> viewer; // that is shown the picture; null without one
  View view;
  // Where huge triangles are cut finely; empty = where the view stands.
  std::optional<glm::dvec3> cut_near;
  MotionPictures motion;
  std::vector<std::string> group_names; // see RenderPlan
  std::optional<MemoryCheck> memory;
  PackedScene packed;
  SceneOnDevice on_device; // the scene as uploaded to `device`, shared by pilots and render
  Plan plan;
  std::uint64_t scene_hash = 0; // hash of the loaded scene; 0 where no identity is needed
  std::string identity;         // identity (identity.h) of the planned render; empty unless sums or a state are written
  Warnings warnings;
  double load_seconds = 0.0; // seconds of loading and packing, without those of building the BVH
};

// Opens the devices, loads the scene, and begins to compile kernels. The last three arguments: as open_scene() takes
// them. Throws Error.
Prepared open(const SceneRequest& scene, const RenderRequest& render, LoadedScene& loaded, bool stays_open,
              const SessionDevice& device = {}, std::span<const char* const> window_extensions = {});
// Poses the loaded scene at the moment of a request. Returns whether every vertex is where it was.
using PoseScene = std::function<bool(const SceneRequest&)>;
// Notes in `prepared` what --aov motion and motion_back are told to. Poses the scene at other moments for that, and
// then again at the one of `scene`. Returns whether every vertex is where it was. Throws Error.
bool pose_others(const SceneRequest& scene, const RenderPlan& settings, const MotionRequest& motion,
                 const PoseScene& pose, const LoadedScene& loaded, Prepared& prepared);
// Packs what `loaded` holds, and returns how. `memory`: as pack_again() takes it; null = the scene is packed once.
// Throws Error.
Packing pack_scene(const SceneRequest& scene, const RenderRequest& render, LoadedScene& loaded, Prepared& prepared,
                   PackMemory* memory = nullptr);

// How lights are chosen where nothing is trained: `--lights auto` packs them as this does.
std::uint32_t usual_lights(const PackedScene& scene);
// How a scene is packed for these settings, as prepared.view sees it.
Packing packing_of(const RenderRequest& render, const Scene& scene, const Prepared& prepared);
// True if both give the same but for what `near` has cut.
bool packs_alike(const Packing& a, const Packing& b);

// Makes the pilots and the plan (host/plan/plan.h). Throws Error.
void plan_render(const RenderRequest& request, Prepared& prepared);

} // namespace wavepath
