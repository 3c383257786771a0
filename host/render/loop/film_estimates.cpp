#include "host/render/loop/film_estimates.h"

#include <system_error>

#include "host/base/clock.h"

namespace wavepath {
namespace {

template <class Read>
FilmEstimate make_estimate(const FilmShape& part, Read read) {
  const auto start = Clock::now();
  FilmEstimate result;
  result.film = std::make_shared<const Film>(read());
  result.error = estimate_error(part == result.film->shape() ? *result.film : cut(*result.film, part));
  result.seconds = seconds_since(start);
  return result;
}

} // namespace

std::shared_ptr<FilmSnapshot> FilmEstimates::copy(Commands& commands, const FilmTarget& film) {
  if (free_.empty()) free_.push_back(std::make_shared<FilmSnapshot>());
  const std::shared_ptr<FilmSnapshot> copy = free_.back();
  copy->fit(device_, film);
  copy->record(commands, film);
  free_.pop_back();
  return copy;
}

std::future<FilmEstimate> FilmEstimates::begin(std::shared_ptr<FilmSnapshot> copy, const FilmShape& part) {
  const auto estimate = [copy = std::move(copy), part] { return make_estimate(part, [&] { return copy->read(); }); };
  try {
    return std::async(std::launch::async, estimate);
  } catch (const std::system_error&) { // no thread can be had, and a render must not end for that
    std::promise<FilmEstimate> now;
    now.set_value(estimate());
    return now.get_future();
  }
}

std::future<FilmEstimate> estimate_now(const FilmTarget& film, const FilmShape& part) {
  std::promise<FilmEstimate> estimate;
  estimate.set_value(make_estimate(part, [&] { return film.download(); }));
  return estimate.get_future();
}

void FilmEstimates::abandon(std::future<FilmEstimate> estimate) {
  std::erase_if(abandoned_, is_there<FilmEstimate>);
  abandoned_.push_back(std::move(estimate));
}

} // namespace wavepath
