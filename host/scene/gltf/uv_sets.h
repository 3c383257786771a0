// Chooses the sets of texture coordinates that vertices carry: kernels read two, while files may have any number.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "host/base/warnings.h"
#include "host/scene/gltf/accessor.h"
#include "host/scene/material.h"

namespace wavepath::gltf {

// The n of TEXCOORD_n in each of the two sets of a vertex.
using UvSets = std::array<std::uint32_t, 2>;

inline constexpr const char* kNoUvSet = "primitive lacks the texture coordinates that its material uses; 0 taken";

// Chooses the sets for a material whose slots name those of the file, and has the slots name those of a vertex.
// Nothing, and the slots stay as they are, where the material reads more than two.
std::optional<UvSets> take_uv_sets(Material& material);

// The same for a material that reads more than two, as one primitive shows it: a set that is an affine map of another
// one there becomes the texture transform that the map is. What still has no place is left out, most important textures
// last, with a warning that names it. Throws Error.
UvSets fit_uv_sets(Document& document, Warnings& warnings, const tinygltf::Primitive& primitive, const Decoded& decoded,
                   Material& material);

} // namespace wavepath::gltf
