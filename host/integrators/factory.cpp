// Lists all integrators; no other file names them.
#include <algorithm>
#include <array>

#include "host/integrators/bidirectional/kind.h"
#include "host/integrators/hybrid/kind.h"
#include "host/integrators/path/kind.h"
#include "host/integrators/radiosity/kind.h"
#include "host/integrators/whitted/kind.h"
#include "host/render/settings/integrator_kind.h"

namespace wavepath {

std::span<const IntegratorKind* const> integrators() {
  static const std::array kAll = {&kPath, &kBidirectional, &kHybrid, &kAo, &kWhitted, &kRadiosity};
  return kAll;
}

const IntegratorKind& default_integrator() { return kPath; }

const IntegratorKind* find_integrator(std::string_view name) {
  const auto found = std::ranges::find(integrators(), name, &IntegratorKind::name);
  return found == integrators().end() ? nullptr : *found;
}

} // namespace wavepath
