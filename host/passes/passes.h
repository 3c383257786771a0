// Passes: channels beside a picture that rays of their own find, after it is rendered. They cost a render that does not
// ask for them nothing, and no integrator knows of them.
//
//     pass          channels                        rays                            texts in the header
//     node          id.node                         through the centres of pixels   wavepath.nodes
//     material      id.material                     through the centres             wavepath.materials
//     depth0        Z0                              through the centres
//     normal0       N0.X N0.Y N0.Z                  through the centres
//     position0     P0.X P0.Y P0.Z                  through the centres
//     geometric     Ng.X Ng.Y Ng.Z                  through the centres
//     uv            uv.X uv.Y                       through the centres
//     motion        motion.X motion.Y               through the centres
//     motion_back   motionBack.X motionBack.Y       through the centres
//     depth_min     Zmin                            of all samples
//     cryptomatte   CryptoObject*, CryptoMaterial*  of all samples                  cryptomatte/*
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "host/passes/cryptomatte.h"
#include "host/passes/motion.h"
#include "host/picture/picture.h"
#include "host/render/render.h"
#include "host/scene/staging/view.h"

namespace wavepath {

// Appends the passes among settings.aovs to `picture`, which has settings.width x settings.height pixels. Coverages are
// those of samples settings.first_sample <= s < last_sample. `motion`: what motion is told between. `progress`: false
// leaves out what is not yet found; returns whether all was. Throws Error if the device fails.
bool add_passes(Device& device, const PackedScene& scene, const View& view, const RenderPlan& settings,
                const MotionPictures& motion, KernelCompiler& kernels, SceneOnDevice& shared,
                const std::function<bool()>& progress, Picture& picture);

// True if a picture holds any pass.
bool has_passes(const Picture& picture);

// Passes of pictures of the same scene and view, joined one after the other: those through centres are equal in all of
// them, coverages and nearest hits are joined. A pass that a part lacks is left out.
struct JoinedPasses {
  std::vector<Channel> centres; // of the first part
  std::map<std::string, JoinedCryptomatte> layers;
  std::optional<Channel> nearest;
  bool has_parts = false;
};
// `part`: rendered with so many `samples`.
void join_passes(JoinedPasses& joined, const Picture& part, std::uint32_t samples);
// Appends those that `picture` lacks.
void add_passes(const JoinedPasses& joined, Picture& picture);

// Names of the header attributes that explain passes.
std::vector<std::string> pass_texts();

} // namespace wavepath
