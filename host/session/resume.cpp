#include "host/session/resume.h"

#include <filesystem>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/failure.h"
#include "host/render/settings/adaptivity.h"
#include "host/render/settings/identity.h"
#include "host/render/workspace/levels.h"

namespace wavepath {

void check_state_file(const StateRequest& request) {
  if (request.file.empty()) return;
  require_writable(request.file);
  std::error_code error;
  if (!request.resume && std::filesystem::exists(request.file, error))
    throw UsageError(request.file, "exists and would be overwritten",
                     "add --resume to go on from it, or delete it first");
}

std::optional<RenderState> read_resumed(const StateRequest& request, const RenderPlan& settings,
                                        const std::string& identity, const DeviceInfo& device, Warnings& warnings) {
  std::error_code error;
  if (!request.resume) return std::nullopt;
  if (!std::filesystem::exists(request.file, error)) {
    warnings.add(request.file + ": no state there yet; the render begins");
    return std::nullopt;
  }
  StateRecord record = read_state(request.file);
  if (const auto difference = first_difference(identity, record.identity))
    throw Error(request.file, fmt::format("is of another render: {}", *difference),
                "use the flags and the scene that it was begun with");
  const RenderState& state = record.state;
  if (state.first_sample != settings.first_sample)
    throw Error(request.file, fmt::format("begins at sample {}, not {}", state.first_sample, settings.first_sample),
                "use the --samples that it was begun with");
  const std::uint32_t end = state.cursor.sample + state.cursor.pass_samples; // also of a pass that is in progress
  const bool adapts = is_adaptive(settings) || !state.levels.empty();
  if (end > (adapts ? whole_steps(settings.last_sample) : settings.last_sample))
    throw Error(request.file, fmt::format("already holds samples up to {}, beyond {}", end, settings.last_sample),
                fmt::format("ask for {} samples or more", end - state.first_sample));
  if (record.device != device_text(device))
    warnings.add(fmt::format("{}: begun on {}; the result is as good, but not bit by bit what one device gives",
                             request.file, record.device));
  return std::move(record.state);
}

std::function<void(const RenderState&)> state_saver(const StateRequest& request, const std::string& identity,
                                                    const std::string& plan, const DeviceInfo& device,
                                                    Warnings& warnings) {
  if (request.file.empty()) return {};
  return [&request, identity, plan, text = device_text(device), &warnings](const RenderState& state) {
    try {
      write_state(request.file, identity, text, plan, state);
    } catch (const std::exception& failure) {
      warnings.add(fmt::format("{} (the render goes on; the file is as it was)", failure_text(failure)));
    }
  };
}

std::string device_text(const DeviceInfo& device) { return fmt::format("{} ({})", device.name, device.driver); }

} // namespace wavepath
