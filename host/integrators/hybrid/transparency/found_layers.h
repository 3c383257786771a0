// Target of techniques that find one layer a pixel and pass: its index in the list, and its depth.
#pragma once

#include <array>

#include "host/integrators/hybrid/transparency/technique.h"
#include "kernels/hybrid/transparency/transparency_types.h"

namespace wavepath {

inline constexpr std::array<AttachmentInfo, 2> kFoundLayer{
    {{.name = "layer", .format = ImageFormat::rg32ui, .clear = {.words = {gpu::kNone, gpu::kNone}}},
     {.name = "depth", .format = ImageFormat::depth32f, .clear = {.depth = 0.0f}}}};
inline constexpr std::array<std::uint32_t, 1> kFoundLayerBindings = {gpu::kBindLayerSeen};

} // namespace wavepath
