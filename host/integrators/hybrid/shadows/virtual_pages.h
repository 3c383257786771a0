// Virtual shadow maps: the resident pages, their slots, and the tiles in which they are drawn.
#pragma once

#include <cstdint>
#include <vector>

#include "host/gpu/image.h"
#include "kernels/hybrid/shadows/shadow_types.h"

namespace wavepath {

// A part of a view that is drawn at once, and the destinations of its resident pages.
struct PageTile {
  std::uint32_t view = 0, number = 0; // row by row within the view
  std::vector<ImagePart> pages;
};

class VirtualPages {
public:
  // Makes a set without resident pages, for `views` views of size x size texels.
  VirtualPages(std::uint32_t views = 0, std::uint32_t size = 1);

  // Makes the pages resident whose word is not 0, view by view, row by row, as long as there are fewer than `most`.
  void add(const std::vector<std::uint32_t>& asked, std::uint64_t most);

  std::uint32_t total() const { return static_cast<std::uint32_t>(slots_.size()); }
  std::uint32_t resident() const { return static_cast<std::uint32_t>(pages_.size()); }
  std::uint32_t pages_of_view() const { return across_ * across_; }
  // Slot of every page, kNone = it is not resident; then the page of every slot.
  std::vector<std::uint32_t> table() const;

  std::uint32_t tile_size() const; // texels along a side
  std::uint32_t tiles_of_view() const;
  // The tiles that have pages in slots from `first_slot` on, each with these pages only.
  std::vector<PageTile> tiles(std::uint32_t first_slot) const;
  // The part of a view that is drawn for its tile of that number. If there is only one tile, the view itself.
  gpu::ShadowView view_of(std::uint32_t tile, const gpu::ShadowView& whole) const;

private:
  std::uint32_t size_, across_;      // texels, pages along a side of a view
  std::vector<std::uint32_t> slots_; // for each page
  std::vector<std::uint32_t> pages_; // for each slot
};

} // namespace wavepath
