// Estimates the error of the film on a thread, from a copy that the device made, while it goes on with the next waves.
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
  double seconds = 0.0; // that reading the copy and estimating took
};

// Copies of the film, used again and again, and the estimates made of them.
class FilmEstimates {
public:
  explicit FilmEstimates(Device& device) : device_(device) {}

  // Records a copy of the film. Throws Error if there is no memory for it.
  std::shared_ptr<FilmSnapshot> copy(Commands& commands, const FilmTarget& film);
  // Once the copy has been waited for. It is free again when the estimate is there.
  std::future<FilmEstimate> begin(std::shared_ptr<FilmSnapshot> copy);
  // Returns a copy that was taken and not given to begin(), or whose estimate has been taken in.
  void give_back(std::shared_ptr<FilmSnapshot> copy) { free_.push_back(std::move(copy)); }
  // An estimate that nobody waits for any more goes on by itself, with the copy that it holds.
  void abandon(std::future<FilmEstimate> estimate);

private:
  Device& device_;
  std::vector<std::shared_ptr<FilmSnapshot>> free_;
  std::vector<std::future<FilmEstimate>> abandoned_;
};

// Estimate of the film itself, at once. Nothing may be in flight.
std::future<FilmEstimate> estimate_now(const FilmTarget& film);

// True if the value of the future is there; false if there is no future.
template <class T>
bool is_there(const std::future<T>& future) {
  return future.valid() && future.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

} // namespace wavepath
