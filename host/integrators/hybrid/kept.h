// Something that is made for a key, and made anew where the key is another.
#pragma once

#include <memory>

namespace wavepath {

// What was made before is gone while something new is made: the device may not hold both at once. If making throws,
// there is nothing.
template <class T, class Key>
class Kept {
public:
  // `make` returns a std::unique_ptr<T>. Returns whether it was called.
  template <class Make>
  bool keep(const Key& key, Make make) {
    if (value_ && key == key_) return false;
    value_.reset();
    value_ = make();
    key_ = key;
    return true;
  }
  void reset() { value_.reset(); }

  explicit operator bool() const { return value_ != nullptr; }
  T* operator->() const { return value_.get(); }

private:
  std::unique_ptr<T> value_;
  Key key_{};
};

} // namespace wavepath
