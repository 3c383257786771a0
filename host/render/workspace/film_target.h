// The film on the device, in bands that fit into one buffer each.
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/film.h"
#include "host/gpu/commands.h"

namespace wavepath {

// Consecutive pixels, in tile order, and their error probes, whose film fits into one buffer of the device, pixels
// first.
struct FilmBand {
  std::uint32_t first_pixel = 0, pixel_count = 0;
  std::uint32_t first_probe = 0, probe_count = 0; // by block
  std::uint32_t picture_pixels = 0;               // of all bands: the entry of the first probe
  Buffer film, aovs, splats;                      // may hold more

  std::uint32_t entries() const { return pixel_count + probe_count; }
  // Where the sums of an entry of the band lie in it.
  std::uint32_t offset_of(std::uint32_t entry) const {
    const bool is_probe = probe_count > 0 && entry >= picture_pixels;
    return is_probe ? pixel_count + entry - picture_pixels - first_probe : entry - first_pixel;
  }
};

class FilmTarget {
public:
  explicit FilmTarget(Device& device) : device_(&device) {}

  // Takes up a film of this shape. `capacity_for_aovs`: kernels that write AOVs may run.
  // Buffers of a larger picture stay. Returns whether any buffer was replaced. Throws Error if the device has no memory
  // for it.
  bool fit(const FilmShape& shape, bool capacity_for_aovs);
  // Sets all samples to none. Nothing may be in flight, here and below.
  void clear();
  Film download() const;
  // A smaller picture, which a pilot put at the beginning of the first band. Its samples are split between two
  // replicates, and it has no AOVs.
  Film download_small(const FilmShape& shape) const;
  void upload(const Film& film);

  const std::vector<FilmBand>& bands() const { return bands_; }
  const FilmShape& shape() const { return shape_; }
  std::uint64_t pixels() const { return shape_.pixels(); }
  std::uint64_t bytes() const;

private:
  Device* device_;
  FilmShape shape_;
  std::vector<FilmBand> bands_;
};

// A copy of the film that the host can read while the device goes on.
class FilmSnapshot {
public:
  // Reserves memory for a film like `target`, which is so large that this may throw Error.
  void fit(Device& device, const FilmTarget& target);
  void record(Commands& commands, const FilmTarget& target) const;
  // Once the commands have been waited for. `target`: as it was when they were recorded.
  Film read() const;

private:
  FilmShape shape_;
  std::vector<FilmBand> bands_;
};

// The bindings of a band of the film, without buffers, and with those of one band.
std::vector<Binding> film_layout();
void add_bindings(const FilmBand& band, std::vector<Binding>& bindings);

} // namespace wavepath
