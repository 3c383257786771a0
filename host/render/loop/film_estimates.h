// Estimates the error of the film on a thread, from a copy made by the device, while the device renders the next waves.
#pragma once

#include <chrono>
#include <future>
#include <memory>
#include <vector>

#include "host/film/error.h"
#include "host/film/film.h"
#include "host/render/workspace/film_target.h"

namespace wavepath {

struct FilmEstimate {
  std::shared_ptr<const Film> film;
  ErrorEstimate error;
  double seconds = 0.0; // seconds of reading the copy and estimating
};

// Pool of copies of the film, and the estimates made from them.
class FilmEstimates {
public:
  explicit FilmEstimates(Device& device) : device_(device) {}

  // Records a copy of the film. Throws Error if there is no memory for it.
  std::shared_ptr<FilmSnapshot> copy(Commands& commands, const FilmTarget& film);
  // Begins an estimate from a copy whose commands have been waited for: of the error of `part`, the film's own shape or
  // a part of it. The copy returns to the pool after the estimate.
  std::future<FilmEstimate> begin(std::shared_ptr<FilmSnapshot> copy, const FilmShape& part);
  // Returns to the pool a copy that was not given to begin(), or whose estimate has been taken in.
  void give_back(std::shared_ptr<FilmSnapshot> copy) { free_.push_back(std::move(copy)); }
  // Detaches an estimate whose result is no longer needed. It keeps its copy until it ends.
  void abandon(std::future<FilmEstimate> estimate);

private:
  Device& device_;
  std::vector<std::shared_ptr<FilmSnapshot>> free_;
  std::vector<std::future<FilmEstimate>> abandoned_;
};

// Estimates the film itself, before returning. Nothing may be in flight.
std::future<FilmEstimate> estimate_now(const FilmTarget& film, const FilmShape& part);

// True if the future has its value; false if there is no future.
template <class T>
bool is_there(const std::future<T>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

} // namespace wavepath
