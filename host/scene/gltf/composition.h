// Makes one JSON document of a glTF file and of the files that are instances in it (external assets of glTF 2.1).
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "host/scene/gltf/document.h"

namespace wavepath::gltf {

// Members of the buffers of the document that compose() returns: the one of Document::chunks that holds the buffer, or
// the buffer view that does.
inline constexpr const char* kStoredChunk = "wavepath.chunk";
inline constexpr const char* kBufferView = "wavepath.bufferView";

// Reads the file Document::path, checks it against the schema, and merges what its nodes refer to, however deep: every
// index names an element of the one document then, and every URI is relative to the folder of the file. Fills `chunks`,
// `assets` and `warnings` of the document. Throws Error.
nlohmann::json compose(Document& document);

} // namespace wavepath::gltf
