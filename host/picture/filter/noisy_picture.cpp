#include "host/picture/filter/noisy_picture.h"

#include <tbb/parallel_for.h>

#include "host/film/film.h"

namespace wavepath {

NoisyPicture noisy_picture(const Film& film) {
  NoisyPicture picture{film.width, film.height, {}, {}, {}, {}, {}, {}};
  const std::size_t pixels = picture.pixels();
  for (auto* values : {&picture.color, &picture.variance, &picture.emission, &picture.albedo, &picture.normal})
    values->resize(pixels);
  picture.depth.resize(pixels);
  tbb::parallel_for(std::size_t{0}, pixels, [&](std::size_t i) {
    const gpu::FilmAovs aovs = mean_aovs(film, i);
    picture.color[i] = mean_radiance(film, i);
    picture.variance[i] = mean_variance(film, i);
    picture.emission[i] = aovs.emission;
    picture.albedo[i] = aovs.albedo;
    picture.normal[i] = aovs.normal;
    picture.depth[i] = aovs.hits > 0.0f ? aovs.depth : 0.0f;
  });
  return picture;
}

} // namespace wavepath
