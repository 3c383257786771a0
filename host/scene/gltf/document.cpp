// Refuses a document, with its name.
#include "host/scene/gltf/document.h"

#include "host/base/error.h"

namespace wavepath::gltf {

void Document::fail(const std::string& problem, const std::string& remedy) const { throw Error(file, problem, remedy); }

} // namespace wavepath::gltf
