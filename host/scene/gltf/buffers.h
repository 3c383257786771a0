// The contents of a document's buffers, read when something first asks for them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// The data in a URI, or of the file that it names: at least `wanted` bytes, or all of it if that is 0. Throws Error
// that calls it `what`.
std::vector<std::uint8_t> uri_bytes(const Document& document, const std::string& what, const std::string& uri,
                                    std::uint64_t wanted);

// The bytes of a buffer from `offset` on, `length` of them. Throws Error.
Bytes buffer_bytes(Document& document, std::size_t buffer, std::uint64_t offset, std::uint64_t length);

} // namespace wavepath::gltf
