// Compiles kernel sets on threads of their own, and hands out the best one that is ready.
#pragma once

#include <condition_variable>
#include <future>
#include <list>
#include <memory>
#include <mutex>
#include <vector>

#include "host/render/workspace/kernel_set.h"

namespace wavepath {

struct RenderPlan;

// Entries of the traversal stack that the tree of nearly every scene gets by with.
inline constexpr std::uint32_t kExpectedStack = 62;

// What generic kernels for a scene of these features have: all, but lobes of layered materials only where it has any,
// since kernels come in a build without their code.
gpu::Feature generic_features(gpu::Feature scene);

// The configuration for a scene of these features whose tree needs `stack_size` entries, under these settings.
KernelConfig kernel_config(gpu::Feature features, std::uint32_t stack_size, const RenderPlan& settings);

// Where a set for many scenes may be at hand sooner than the one for this scene (as on GPUs, whose drivers take seconds
// for new kernels but none for those in the pipeline cache), rendering begins with that. CPU drivers compile at the
// first dispatch, one kernel at a time, and would only be kept busy.
bool generic_first(const DeviceInfo& device);

// kFeature bits that the settings ask of kernels, whatever the scene.
gpu::Feature features_of(const RenderPlan& settings);

// Whether next-event estimation goes by the light tree where a scene has one.
bool walks_light_tree(const RenderPlan& settings);

// Whether shadow rays pass thin smooth panes where a scene has some: a pane costs them a bounce.
bool passes_panes(const RenderPlan& settings);

class KernelCompiler {
public:
  explicit KernelCompiler(Device& device) : device_(device) {}
  KernelCompiler(KernelCompiler&&) = delete; // waits for what it began

  // Returns at once; what was begun before is not begun again.
  void start(const KernelNeed& need);

  // A set that renders what `need` asks for: the one made for just that once it is ready; until then any other that is
  // ready, and while there is none, the first to come. Throws what compiling threw.
  const KernelSet& best(const KernelNeed& need);

  // Whether best() would return at once, or throw what compiling threw. Begins compiling otherwise.
  bool ready(const KernelNeed& need);

  // All sets that were begun, once they are ready. Throws what compiling threw.
  std::vector<const KernelSet*> all();

  // kFeature bits of all sets of the program that were begun: what buffers have to be there for.
  gpu::Feature features(const KernelProgram& program) const;

private:
  struct Entry {
    KernelNeed made_for;
    std::unique_ptr<KernelSet> set; // null until it is ready, or if it failed
    std::exception_ptr failure;
    std::future<void> compiling;
  };
  const Entry* choose(const KernelNeed& need) const;

  Device& device_;
  mutable std::mutex mutex_; // of all but `compiling`
  std::condition_variable changed_;
  std::list<Entry> entries_; // last: goes first, and so waits for its threads
};

} // namespace wavepath
