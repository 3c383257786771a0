// Memory of large arrays that are filled once: uninitialized, and on huge pages if the system has them.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace wavepath::bvh {

// Allocates `bytes`, aligned to a huge page if large, else to a cache line. Must be released by release_memory().
void* get_memory(std::size_t bytes);
void release_memory(void* memory);

struct ReleaseMemory {
  void operator()(void* memory) const { release_memory(memory); }
};
template <class T>
using Array = std::unique_ptr<T[], ReleaseMemory>;

// Allocates an uninitialized array.
template <class T>
Array<T> make_array(std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  return Array<T>(static_cast<T*>(get_memory(count * sizeof(T))));
}

} // namespace wavepath::bvh
