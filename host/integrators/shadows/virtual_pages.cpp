#include "host/integrators/shadows/virtual_pages.h"

#include <algorithm>
#include <map>
#include <tuple>

namespace wavepath {
namespace {

constexpr std::uint32_t kPage = gpu::kShadowPage;
constexpr std::uint32_t kTilePages = 8; // along a side: large enough that few tiles draw the same triangles

} // namespace

VirtualPages::VirtualPages(std::uint32_t views, std::uint32_t size)
    : size_(size), across_((size + kPage - 1) / kPage), slots_(std::size_t{views} * across_ * across_, gpu::kNone) {}

bool VirtualPages::add(const std::vector<std::uint32_t>& asked, std::uint64_t most) {
  const std::size_t before = pages_.size();
  for (std::uint32_t page = 0; page < slots_.size(); ++page) {
    if (asked[page] == 0 || slots_[page] != gpu::kNone || pages_.size() >= most) continue;
    slots_[page] = resident();
    pages_.push_back(page);
  }
  return pages_.size() > before;
}

std::vector<std::uint32_t> VirtualPages::table() const {
  std::vector<std::uint32_t> words = slots_;
  words.insert(words.end(), pages_.begin(), pages_.end());
  return words;
}

std::uint32_t VirtualPages::tile_size() const { return std::min(size_, kTilePages * kPage); }

std::vector<PageTile> VirtualPages::tiles() const {
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, PageTile> tiles;
  for (std::uint32_t slot = 0; slot < pages_.size(); ++slot) {
    const std::uint32_t view = pages_[slot] / pages_of_view(), x = pages_[slot] % across_,
                        y = pages_[slot] % pages_of_view() / across_;
    PageTile& tile = tiles[{view, y / kTilePages, x / kTilePages}];
    tile.view = view, tile.x = x / kTilePages, tile.y = y / kTilePages;
    const std::uint32_t left = x % kTilePages * kPage, top = y % kTilePages * kPage;
    tile.pages.push_back({left, top, std::min(kPage, tile_size() - left), std::min(kPage, tile_size() - top),
                          std::uint64_t{slot} * kPage * kPage * sizeof(float), kPage});
  }
  std::vector<PageTile> list;
  for (auto& [at, tile] : tiles) list.push_back(std::move(tile));
  return list;
}

gpu::ShadowView VirtualPages::view_of(const PageTile& tile, const gpu::ShadowView& whole) const {
  const float scale = static_cast<float>(size_) / static_cast<float>(tile_size());
  gpu::ShadowView view = whole;
  view.x = scale * whole.x - (2.0f * static_cast<float>(tile.x) + 1.0f - scale) * whole.w;
  view.y = scale * whole.y - (2.0f * static_cast<float>(tile.y) + 1.0f - scale) * whole.w;
  return view;
}

} // namespace wavepath
