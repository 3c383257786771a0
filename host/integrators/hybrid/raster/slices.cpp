#include "host/integrators/hybrid/raster/slices.h"

#include <algorithm>
#include <vector>

namespace wavepath {
namespace {

// No submission should keep the device for longer than a tenth of a second; less than half of that on average leaves
// room for slices that are not alike. The average decides, because a busy machine delays one or another of any size,
// and because every slice costs what loading and storing the picture does.
constexpr double kLongSlice = 0.04, kShortSlice = 0.01; // seconds
constexpr std::uint64_t kSmallestSlice = 1 << 12;

// The draws in pieces of at most `most` triangles; at least one piece.
std::vector<std::vector<VertexRange>> cut(std::span<const Draw> draws, std::uint64_t most) {
  std::vector<std::vector<VertexRange>> slices(1);
  std::uint64_t capacity = most;
  for (const Draw& draw : draws) {
    const std::uint64_t total = std::uint64_t{draw.triangle_count} * draw.instance_count;
    for (std::uint64_t done = 0; done < total;) {
      if (capacity == 0) {
        slices.emplace_back();
        capacity = most;
      }
      // As many whole instances as fit, or a part of one.
      const auto instance = static_cast<std::uint32_t>(done / draw.triangle_count);
      const auto first = static_cast<std::uint32_t>(done % draw.triangle_count);
      const std::uint32_t left = draw.triangle_count - first;
      const bool whole = first == 0 && capacity >= left;
      const std::uint32_t times =
          whole ? static_cast<std::uint32_t>(std::min<std::uint64_t>(draw.instance_count - instance, capacity / left))
                : 1;
      const std::uint32_t count = whole ? left : static_cast<std::uint32_t>(std::min<std::uint64_t>(left, capacity));
      slices.back().push_back({3 * (draw.first_triangle + first), 3 * count, draw.first_instance + instance, times});
      done += std::uint64_t{count} * times;
      capacity -= std::uint64_t{count} * times;
    }
  }
  return slices;
}

} // namespace

std::uint64_t SliceLength::next_frame() {
  if (count_ > 0) {
    const double average = seconds_ / static_cast<double>(count_);
    if (average > kLongSlice)
      size_ = std::max(kSmallestSlice, size_ / 2);
    else if (average < kShortSlice && count_ > 1)
      size_ *= 2;
  }
  seconds_ = 0.0;
  count_ = 0;
  return size_;
}

void draw_in_slices(WaveQueue& queue, const SlicedPass& pass, std::span<const Draw> draws, std::uint64_t triangles,
                    const std::function<void(Commands&)>& before, const std::function<void(Commands&)>& after,
                    const std::function<void(double)>& done) {
  const std::vector<std::vector<VertexRange>> slices = cut(draws, triangles);
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const auto record = [&](Commands& commands) {
      if (i == 0) before(commands);
      const RasterDraw draw{pass.pipeline, pass.bindings, pass.push, slices[i]};
      pass.target->draw(commands,
                        {.draws = {&draw, 1}, .clear = i == 0 ? pass.clear : kClearNothing, .layer = pass.layer});
      if (i + 1 == slices.size()) after(commands);
    };
    queue.submit(record, {.stage = pass.stage, .done = [done](const Finished& finished) { done(finished.seconds); }});
  }
}

} // namespace wavepath
