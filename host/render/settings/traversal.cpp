#include "host/render/settings/traversal.h"

#include "host/base/error.h"

namespace wavepath {

std::uint32_t traversal_of(const RenderPlan& settings) {
  if (settings.moving && settings.traversal == kTraversalHardware)
    throw Error("--traversal hardware", "cannot trace surfaces that move while the shutter is open",
                "use --traversal compute, or leave out --shutter");
  return settings.moving ? kTraversalCompute : settings.traversal;
}

bool traces_by_query(std::uint32_t traversal, const DeviceInfo& device) {
  if (traversal == kTraversalHardware && !device.has_ray_queries)
    throw Error(device.name, "has no ray queries", "use --traversal compute");
  // A driver for CPUs may offer them, and takes ten to a thousand times as long as our own traversal.
  return device.has_ray_queries &&
         (traversal == kTraversalHardware || (traversal == kTraversalAuto && device.type != "cpu"));
}

} // namespace wavepath
