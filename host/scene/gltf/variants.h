// KHR_materials_variants: materials of primitives by the name of a variant.
#pragma once

#include <string>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Gives every primitive the material that it has in this variant; empty: that of the file without any. Returns whether
// one has another material than before. Throws Error, which lists the names, if there is no such variant.
bool choose_variant(Document& document, const std::string& name);

// The materials that a primitive has in all variants, -1 for the default one.
std::vector<int> all_materials(const tinygltf::Primitive& primitive);

} // namespace wavepath::gltf
