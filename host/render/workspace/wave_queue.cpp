#include "host/render/workspace/wave_queue.h"

#include <algorithm>
#include <cstring>
#include <utility>

#include "host/render/workspace/workspace.h"

namespace wavepath {
namespace {

gpu::Counters no_counts() {
  gpu::Counters counters{};
  std::ranges::fill(counters.nonfinite_first, gpu::kNone);
  return counters;
}

std::uint64_t join(const std::uint32_t words[2]) { return std::uint64_t{words[1]} << 32 | words[0]; }

} // namespace

WaveQueue::WaveResources::WaveResources(Device& device)
    : commands(device), counters(device, sizeof(gpu::Counters), BufferHome::readback) {}

WaveQueue::WaveQueue(Workspace& workspace)
    : workspace_(workspace), resources_{WaveResources(workspace.device), WaveResources(workspace.device)} {}

void WaveQueue::submit(const std::function<void(Commands&)>& record, Work work) {
  while (in_flight_.size() >= resources_.size()) finish_one();
  workspace_.device.prepare_workers();
  WaveResources& resources = resources_[next_resources_];
  resources.commands.restart(work.timed_dispatches);
  const gpu::Counters none = no_counts();
  resources.commands.write(workspace_.counters(), &none, sizeof(none));
  record(resources.commands);
  resources.commands.copy(workspace_.counters(), resources.counters, sizeof(none));
  resources.commands.submit();
  in_flight_.push_back({&resources, std::move(work), Clock::now(), {}});
  next_resources_ = (next_resources_ + 1) % resources_.size();
}

void WaveQueue::afterwards(std::function<void()> action) {
  if (in_flight_.empty())
    action();
  else
    in_flight_.back().afterwards.push_back(std::move(action));
}

bool WaveQueue::finish_one() {
  if (in_flight_.empty()) return false;
  in_flight_.front().resources->commands.wait();
  Flight flight = std::move(in_flight_.front());
  in_flight_.pop_front();
  const Finished finished = count(flight);
  if (flight.work.done) flight.work.done(finished);
  for (const auto& action : flight.afterwards) action();
  return true;
}

void WaveQueue::drain() {
  while (finish_one()) {
  }
}

void WaveQueue::abandon() noexcept {
  for (Flight& flight : in_flight_) try {
      flight.resources->commands.wait();
    } catch (...) { // the device is lost; there is nothing to wait for
    }
  in_flight_.clear();
}

Finished WaveQueue::count(Flight& flight) {
  const Clock::time_point now = Clock::now();
  Finished finished;
  finished.seconds = std::chrono::duration<double>(now - std::max(flight.submitted, last_finished_)).count();
  last_finished_ = now;
  for (const KernelTime& time : flight.resources->commands.times()) {
    count_time(time.kernel->name(), time.seconds);
    finished.longest_dispatch = std::max(finished.longest_dispatch, time.seconds);
    finished.device_seconds += time.seconds;
  }
  // A host that came late, as a window does, saw the device idle; dispatches that were timed tell how long it worked.
  const bool timed = finished.device_seconds > 0.0 && !flight.work.stage;
  totals.busy_seconds += timed ? std::min(finished.seconds, finished.device_seconds) : finished.seconds;
  if (flight.work.stage) count_time(flight.work.stage, finished.seconds);
  gpu::Counters counters;
  flight.resources->counters.invalidate();
  std::memcpy(&counters, flight.resources->counters.mapped(), sizeof(counters));
  count_counters(counters, flight.work.wave);
  return finished;
}

void WaveQueue::count_counters(const gpu::Counters& counters, const std::optional<gpu::Wave>& wave) {
  totals.rays.camera += join(counters.camera_rays);
  totals.rays.bounce += join(counters.bounce_rays);
  totals.rays.shadow += join(counters.shadow_rays);
  totals.rays.occlusion += join(counters.occlusion_rays);
  if (wave) totals.nonfinite.add(counters, *wave, [this](std::uint32_t entry) { return workspace_.pixel_at(entry); });
}

void WaveQueue::count_time(const std::string& name, double seconds) {
  auto stage = std::ranges::find(totals.stages, name, &StageTime::name);
  if (stage == totals.stages.end()) stage = totals.stages.insert(stage, {name, 0.0, 0});
  stage->seconds += seconds;
  ++stage->dispatches;
}

} // namespace wavepath
