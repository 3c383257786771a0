// The film on the device, in bands that fit into one buffer each.
#pragma once

#include <cstdint>
#include <vector>

#include "host/film/film.h"
#include "host/gpu/commands.h"

namespace wavepath {

// Consecutive pixels, in tile order, whose film fits into one buffer of the device.
struct FilmBand {
  std::uint32_t first_pixel = 0, pixel_count = 0;
  Buffer film, aovs, splats; // may have room for more
};

class FilmTarget {
public:
  explicit FilmTarget(Device& device) : device_(&device) {}

  // Takes up a picture of this size. `aovs`: the film has AOVs. `room_for_aovs`: kernels that write them may run.
  // `splats`: light paths bring light to it.
  // Buffers of a larger picture stay. Returns whether any buffer was replaced. Throws Error if the device has no memory
  // for it.
  bool fit(std::uint32_t width, std::uint32_t height, bool aovs, bool room_for_aovs, bool splats);
  // Sets all samples to none. Nothing may be in flight, here and below.
  void clear();
  Film download() const;
  void upload(const Film& film);

  const std::vector<FilmBand>& bands() const { return bands_; }
  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }
  std::uint64_t pixels() const { return std::uint64_t{width_} * height_; }
  bool has_aovs() const { return has_aovs_; }
  bool has_splats() const { return has_splats_; }
  std::uint64_t bytes() const;

private:
  Device* device_;
  std::uint32_t width_ = 0, height_ = 0;
  bool has_aovs_ = false, has_splats_ = false;
  std::vector<FilmBand> bands_;
};

// A copy of the film that the host can read while the device goes on.
class FilmSnapshot {
public:
  // Makes room for a film like `target`, which is so large that this may throw Error.
  void fit(Device& device, const FilmTarget& target);
  void record(Commands& commands, const FilmTarget& target) const;
  // Once the commands have been waited for. `target`: as it was when they were recorded.
  Film read() const;

private:
  struct Band {
    std::uint32_t first_pixel = 0, pixel_count = 0;
    Buffer film, aovs, splats;
  };
  std::uint32_t width_ = 0, height_ = 0;
  bool has_aovs_ = false, has_splats_ = false;
  std::vector<Band> bands_;
};

// The bindings of a band of the film, without buffers, and with those of one band.
std::vector<Binding> film_layout();
void add_bindings(const FilmBand& band, std::vector<Binding>& bindings);

} // namespace wavepath
