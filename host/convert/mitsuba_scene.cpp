#include "host/convert/mitsuba_scene.h"

#include "host/base/error.h"

namespace wavepath::convert {

Description read_mitsuba(const std::string& path) { throw Error(path, "is not read yet", "wait"); }

} // namespace wavepath::convert
