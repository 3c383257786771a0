// Compiles kernel sets on separate threads, and returns the best set that is ready.
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

// Entries of the traversal stack that suffice for the BVH of nearly every scene.
inline constexpr std::uint32_t kExpectedStack = 62;

// Features of generic kernels for such a scene: all of them. Lobes of layered materials are excluded unless the scene
// has some, since there is a second build of the kernels without their code.
gpu::Feature generic_features(gpu::Feature scene);

// Configuration of kernels for a scene of these features, whose BVH needs `stack_size` entries, and these settings.
KernelConfig kernel_config(gpu::Feature features, std::uint32_t stack_size, const RenderPlan& settings);
// That of generic kernels that stand in for it.
KernelConfig generic_config(gpu::Feature scene, std::uint32_t stack_size, const RenderPlan& settings);

// True if rendering should begin with generic kernels while specialized ones are compiled. GPU drivers take seconds for
// new kernels, but none for those in the pipeline cache. CPU drivers compile at the first dispatch, one kernel at a
// time, so generic kernels would only delay them.
bool generic_first(const DeviceInfo& device);

// kFeature bits that the settings require, whatever the scene.
gpu::Feature features_of(const RenderPlan& settings);

// True if next-event estimation uses the light tree of a scene that has one.
bool walks_light_tree(const RenderPlan& settings);

// True if shadow rays pass thin smooth panes of a scene that has some. A pane counts as a bounce.
bool passes_panes(const RenderPlan& settings);

class KernelCompiler {
public:
  explicit KernelCompiler(Device& device) : device_(device) {}
  KernelCompiler(KernelCompiler&&) = delete; // not movable: threads refer to it; its destructor waits for them

  // Begins compiling a set, unless that was begun before. Returns at once.
  void start(const KernelNeed& need);

  // Returns a set that renders what `need` asks for: the specialized one if it is ready, else another suitable one that
  // is ready, else the first to become ready. Throws what compiling threw.
  const KernelSet& best(const KernelNeed& need);

  // True if best() would return or throw at once. Otherwise begins compiling.
  bool ready(const KernelNeed& need);

  // Waits for all sets that were begun, and returns them. Throws what compiling threw.
  std::vector<const KernelSet*> all();

  // kFeature bits of all sets of the program that were begun: the data that buffers must have.
  gpu::Feature features(const KernelProgram& program) const;

private:
  struct Entry {
    KernelNeed made_for;
    std::unique_ptr<KernelSet> set; // null until it is ready, and if it failed
    std::exception_ptr failure;
    std::future<void> compiling;
  };
  const Entry* choose(const KernelNeed& need) const;

  Device& device_;
  mutable std::mutex mutex_; // guards every member of the entries but `compiling`
  std::condition_variable changed_;
  std::list<Entry> entries_; // last member, so that it is destroyed first and waits for its threads
};

} // namespace wavepath
