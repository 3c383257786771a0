// A cached object: made for a key, and made again when the key changes.
#pragma once

#include <memory>

namespace wavepath {

// The old object is destroyed before the new one is made, since the device may not hold both. If making throws, there
// is no object.
template <class T, class Key>
class Kept {
public:
  // Makes the object by `make`, which returns std::unique_ptr<T>, unless there is one for this key. Returns true if it
  // was made.
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
  T* get() const { return value_.get(); }

private:
  std::unique_ptr<T> value_;
  Key key_{};
};

} // namespace wavepath
