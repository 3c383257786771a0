// Large arrays that are filled once: without initial values, on huge pages where the system has them.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace wavepath::bvh {

// `bytes` on a huge page's boundary if they are many, else on a cache line's. Released by release_memory().
void* get_memory(std::size_t bytes);
void release_memory(void* memory);

struct ReleaseMemory {
  void operator()(void* memory) const { release_memory(memory); }
};
template <class T>
using Array = std::unique_ptr<T[], ReleaseMemory>;

// Uninitialised.
template <class T>
Array<T> make_array(std::size_t count) {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_destructible_v<T>);
  return Array<T>(static_cast<T*>(get_memory(count * sizeof(T))));
}

} // namespace wavepath::bvh
