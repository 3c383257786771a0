#include "host/render/workspace/resources.h"

#include <algorithm>

namespace wavepath {

bool reserve(Device& device, Buffer& buffer, std::uint64_t bytes) {
  if (buffer.handle() && buffer.bytes() >= bytes) return false;
  buffer = Buffer(); // the device may not hold both at once
  buffer = Buffer(device, bytes);
  return true;
}

bool BufferSet::fit(const BufferDimensions& dimensions) {
  bool moved = false;
  for (std::size_t i = 0; i < rules_.size(); ++i)
    if (rules_[i].bytes) moved |= reserve(*device_, buffers_[i], rules_[i].bytes(dimensions));
  return moved;
}

void BufferSet::add_bindings(std::vector<Binding>& bindings) const {
  std::size_t at = bindings.size();
  add_layout(rules_, bindings);
  for (std::size_t i = 0; i < rules_.size(); ++i)
    for (std::size_t view = 0; view < rules_[i].views.size(); ++view) bindings[at++].buffer = &buffers_[i];
}

std::uint64_t BufferSet::bytes() const {
  std::uint64_t sum = 0;
  for (const Buffer& buffer : buffers_) sum += buffer.bytes();
  return sum;
}

void add_layout(std::span<const BufferRule> rules, std::vector<Binding>& bindings) {
  for (const BufferRule& rule : rules) {
    const auto words = std::ranges::find(rule.views, BindingKind::storage, &BufferView::kind);
    for (const BufferView& view : rule.views) {
      bindings.push_back({.slot = view.slot, .kind = view.kind});
      if (is_texels(view.kind) && words != rule.views.end()) bindings.back().words = words->slot;
    }
  }
}

} // namespace wavepath
