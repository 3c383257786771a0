// The film on the device, in bands that fit into one buffer each.
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/film.h"
#include "host/gpu/commands.h"

namespace wavepath {

// Band of the film: consecutive pixels in tile order and their error probes, as many as fit into one buffer of the
// device. The buffer has the pixels first.
struct FilmBand {
  std::uint32_t first_pixel = 0, pixel_count = 0;
  std::uint32_t first_probe = 0, probe_count = 0; // range of blocks whose probes it has
  std::uint32_t picture_pixels = 0;               // pixels of all bands, which is the entry of the first probe
  // May be larger than needed. Behind the splats of the picture are those of its groups of lights.
  Buffer film, aovs, splats, groups, cover;

  std::uint32_t entries() const { return pixel_count + probe_count; }
  // Offset within the band of the sums of an entry.
  std::uint32_t offset_of(std::uint32_t entry) const {
    const bool is_probe = probe_count > 0 && entry >= picture_pixels;
    return is_probe ? pixel_count + entry - picture_pixels - first_probe : entry - first_pixel;
  }
};

class FilmTarget {
public:
  explicit FilmTarget(Device& device) : device_(&device) {}

  // Prepares for a film of this shape. `capacity_for_aovs`: kernels that write AOVs may run. Keeps buffers that are
  // large enough. Returns true if a buffer was replaced. Throws Error if the device has no memory for it.
  bool fit(const FilmShape& shape, bool capacity_for_aovs);
  // Removes all samples. Nothing may be in flight, here and below.
  void clear();
  Film download() const;
  // Reads the smaller picture that a pilot put at the beginning of the first band. Its samples are split between two
  // replicates, and it has no AOVs.
  Film download_small(const FilmShape& shape) const;
  void upload(const Film& film);

  const std::vector<FilmBand>& bands() const { return bands_; }
  const FilmShape& shape() const { return shape_; }
  std::uint64_t pixels() const { return shape_.pixels(); }
  std::uint64_t bytes() const;
  // Limit of the film of a pilot, the same for a part of a picture and the whole.
  std::uint64_t pilot_bytes() const { return pilot_bytes_; }

private:
  Device* device_;
  FilmShape shape_;
  std::vector<FilmBand> bands_;
  std::uint64_t pilot_bytes_ = 0;
};

// Copy of a film, which the host can read while the device continues.
class FilmSnapshot {
public:
  // Reserves memory for a copy of `target`. Throws Error if there is not enough, which large films make likely.
  void fit(Device& device, const FilmTarget& target);
  void record(Commands& commands, const FilmTarget& target) const;
  // Reads the copy, once the commands have been waited for. Uses the shape that `target` had when they were recorded.
  Film read() const;

private:
  FilmShape shape_;
  std::vector<FilmBand> bands_;
};

// Bindings of a band of the film: without buffers, for a layout; and with those of a band.
std::vector<Binding> film_layout();
void add_bindings(const FilmBand& band, std::vector<Binding>& bindings);

} // namespace wavepath
