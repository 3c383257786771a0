// A 64-bit hash of bytes, which tells contents apart and finds damage. It is no defence against forgery.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>
#include <type_traits>
#include <vector>

namespace wavepath {

class Hash {
public:
  // Eight bytes at a time; the last, incomplete word carries its length. The same bytes in other pieces hash differently.
  void add_bytes(const void* data, std::size_t size) {
    const char* bytes = static_cast<const char*>(data);
    for (; size >= 8; bytes += 8, size -= 8) {
      std::uint64_t word;
      std::memcpy(&word, bytes, 8);
      add_word(word);
    }
    std::uint64_t rest = 0;
    if (size > 0) std::memcpy(&rest, bytes, size);
    add_word(rest << 8 | size);
  }

  // A value that has neither padding nor pointers.
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    add_bytes(&value, sizeof(T));
  }
  template <class T>
  void add_all(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T> && !std::is_pointer_v<T>);
    add(values.size());
    add_bytes(values.data(), values.size() * sizeof(T));
  }

  std::uint64_t value() const { return state_; }

private:
  // Multiplies and folds, as the finalizer of MurmurHash3 does. Both steps are invertible, so that data which differ in one
  // word never have the same hash.
  void add_word(std::uint64_t word) {
    state_ = (state_ ^ word) * 0xff51afd7ed558ccdull;
    state_ ^= state_ >> 32;
  }

  std::uint64_t state_ = 0x9e3779b97f4a7c15ull;
};

inline std::uint64_t hash_bytes(std::string_view bytes) {
  Hash hash;
  hash.add_bytes(bytes.data(), bytes.size());
  return hash.value();
}

} // namespace wavepath
