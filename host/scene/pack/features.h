// Finds the kernel features that a packed scene needs, and lists those that it leaves out.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/pack/packed_scene.h"
#include "host/scene/usage.h"

namespace wavepath {

// The kFeature bits of a scene whose arrays are all packed. Bits that depend on the picture (kFeatureAovs,
// kFeatureOrthographic) are 0.
gpu::Feature find_features(const Scene& scene, const Usage& usage, const PackedScene& packed);

// An estimate of find_features() from everything but the contents of images and the sizes of triangles, so that kernels
// can be compiled while the scene is packed. A bit too many costs speed; a bit too few costs a second compilation.
gpu::Feature expected_features(const Scene& scene, std::uint32_t direct);

// Reason why a scene with some of the lobes `lacked` cannot be rendered without them; empty if it has none.
std::string lacked_lobes(const PackedScene& packed, gpu::Feature lacked);
// Throws Error if the scene has any of the lobes `lacked`, which `integrator` cannot render.
void refuse_lobes(const PackedScene& packed, gpu::Feature lacked, std::string_view integrator);

// One entry for every clear bit of packed.features: the reason, and the bytes that its data would take.
std::vector<LeftOut> list_left_out(const Usage& usage, const PackedScene& packed, std::uint32_t direct);

} // namespace wavepath
