// What a packed scene needs of the kernels, and the list of what it does without.
#pragma once

#include <cstdint>
#include <vector>

#include "host/scene/pack/pack.h"
#include "host/scene/usage.h"

namespace wavepath {

// The kFeature bits of a scene whose arrays are all packed. Those that depend on the picture rather than the scene
// (kFeatureAovs, kFeatureOrthographic) are left clear.
std::uint32_t find_features(const Scene& scene, const Usage& usage, const PackedScene& packed);

// What find_features() will most likely say, from all of the scene but the contents of its images and the sizes of its
// triangles: for those who cannot wait. A bit too many costs speed, a bit too few the time of doing it again.
std::uint32_t expected_features(const Scene& scene, std::uint32_t direct);

// One entry for every clear bit of packed.features: why this scene does without, and the bytes its data would have
// taken.
std::vector<LeftOut> list_left_out(const Usage& usage, const PackedScene& packed, std::uint32_t direct);

} // namespace wavepath
