// Virtual shadow maps: which of their pages are resident, where these are kept, and in which tiles they are drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "host/gpu/image.h"
#include "kernels/shadows/shadow_types.h"

namespace wavepath {

// A part of a view that is drawn at once, and where its resident pages go.
struct PageTile {
  std::uint32_t view = 0, x = 0, y = 0; // counted in tiles
  std::vector<ImagePart> pages;
};

class VirtualPages {
public:
  // No page is resident then. `views` of size x size texels.
  VirtualPages(std::uint32_t views = 0, std::uint32_t size = 1);

  // Makes the pages resident whose word is not 0, view by view, row by row, as long as there are fewer than `most`.
  // False if none came.
  bool add(const std::vector<std::uint32_t>& asked, std::uint64_t most);

  std::uint32_t total() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::uint32_t resident() const { return static_cast<std::uint32_t>(pages_.size()); }
  std::uint32_t pages_of_view() const { return across_ * across_; }
  std::uint64_t resident_texels() const { return std::uint64_t{resident()} * gpu::kShadowPage * gpu::kShadowPage; }
  // Slot of every page, kNone = it is not resident; then the page of every slot.
  std::vector<std::uint32_t> table() const;

  std::uint32_t tile_size() const; // texels along a side
  std::vector<PageTile> tiles() const;
  // What is drawn of a view for a tile. With one tile, the view itself.
  gpu::ShadowView view_of(const PageTile& tile, const gpu::ShadowView& whole) const;

private:
  std::uint32_t size_, across_;      // texels, pages along a side of a view
  std::vector<std::uint32_t> slots_; // by page
  std::vector<std::uint32_t> pages_; // by slot
};

} // namespace wavepath
