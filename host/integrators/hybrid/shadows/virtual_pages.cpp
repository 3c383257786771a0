#include "host/integrators/hybrid/shadows/virtual_pages.h"

#include <algorithm>
#include <map>
#include <utility>

namespace wavepath {
namespace {

constexpr std::uint32_t kPage = gpu::kShadowPage;
constexpr std::uint32_t kTilePages = 8; // along a side: large enough that few tiles draw the same triangles

} // namespace

VirtualPages::VirtualPages(std::uint32_t views, std::uint32_t size)
    : size_(size), across_((size + kPage - 1) / kPage), slots_(std::size_t{views} * across_ * across_, gpu::kNone) {}

void VirtualPages::add(const std::vector<std::uint32_t>& asked, std::uint64_t most) {
  for (std::uint32_t page = 0; page < slots_.size(); ++page) {
    if (asked[page] == 0 || slots_[page] != gpu::kNone || pages_.size() >= most) continue;
    slots_[page] = resident();
    pages_.push_back(page);
  }
}

std::vector<std::uint32_t> VirtualPages::table() const {
  std::vector<std::uint32_t> words = slots_;
  words.insert(words.end(), pages_.begin(), pages_.end());
  return words;
}

std::uint32_t VirtualPages::tile_size() const { return std::min(size_, kTilePages * kPage); }

std::uint32_t VirtualPages::tiles_of_view() const {
  const std::uint32_t across = (across_ + kTilePages - 1) / kTilePages;
  return across * across;
}

std::vector<PageTile> VirtualPages::tiles(std::uint32_t first_slot) const {
  const std::uint32_t across = (across_ + kTilePages - 1) / kTilePages;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::vector<ImagePart>> tiles;
  for (std::uint32_t slot = first_slot; slot < pages_.size(); ++slot) {
    const std::uint32_t view = pages_[slot] / pages_of_view(), x = pages_[slot] % across_,
                        y = pages_[slot] % pages_of_view() / across_;
    const std::uint32_t left = x % kTilePages * kPage, top = y % kTilePages * kPage;
    tiles[{view, y / kTilePages * across + x / kTilePages}].push_back(
        {left, top, std::min(kPage, tile_size() - left), std::min(kPage, tile_size() - top),
         std::uint64_t{slot} * kPage * kPage * sizeof(float), kPage});
  }
  std::vector<PageTile> list;
  for (auto& [at, pages] : tiles) list.push_back({at.first, at.second, std::move(pages)});
  return list;
}

gpu::ShadowView VirtualPages::view_of(std::uint32_t tile, const gpu::ShadowView& whole) const {
  const std::uint32_t across = (across_ + kTilePages - 1) / kTilePages;
  const float scale = static_cast<float>(size_) / static_cast<float>(tile_size());
  const auto part = [&](const gpu::vec4& row, std::uint32_t at) {
    return scale * row - (2.0f * static_cast<float>(at) + 1.0f - scale) * whole.w;
  };
  gpu::ShadowView view = whole;
  view.x = part(whole.x, tile % across);
  view.y = part(whole.y, tile / across);
  return view;
}

} // namespace wavepath
