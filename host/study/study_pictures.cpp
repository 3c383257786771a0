#include "host/study/study_pictures.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "host/picture/error_map.h"
#include "host/picture/files/picture_io.h"
#include "host/study/tables.h"

namespace wavepath {
namespace {

double middle_exposure(const Picture& reference) {
  constexpr double kGrey = 0.25, kMostStops = 20.0;
  double sum = 0.0;
  for (std::size_t c = 0; c < 3; ++c)
    for (const float value : reference.channels[c].values) sum += std::clamp(value, 0.0f, 1e30f);
  const double mean = sum / (3.0 * static_cast<double>(reference.channels[0].values.size()));
  return mean > 0.0 ? std::clamp(std::log2(kGrey / mean), -kMostStops, kMostStops) : 0.0;
}

double brightest_flip(const Study& study, double seconds) {
  std::vector<float> all;
  for (const Series& series : study.series)
    if (const StudyPicture* shown = picture_near(series, seconds))
      all.insert(all.end(), shown->flip.begin(), shown->flip.end());
  if (all.empty()) return 1.0;
  const auto percentile = all.begin() + static_cast<std::ptrdiff_t>(all.size() - 1 - all.size() / 100);
  std::nth_element(all.begin(), percentile, all.end());
  return *percentile > 0.0f ? *percentile : 1.0;
}

} // namespace

StudyPictures plan_pictures(const Study& study) {
  const double seconds = equal_time(study).seconds;
  return {seconds, middle_exposure(study.reference.picture), brightest_flip(study, seconds)};
}

std::vector<std::string> picture_names(const std::string& configuration) {
  std::vector<std::string> names;
  for (const char* kind : {"", "-error", "-false-shadows"})
    names.push_back("pictures/" + configuration + kind + ".png");
  return names;
}

std::string picture_name(const Series& series) { return picture_names(series.configuration.name("-"))[0]; }
std::string map_name(const Series& series) { return picture_names(series.configuration.name("-"))[1]; }

std::string false_shadow_name(const Series& series) { return picture_names(series.configuration.name("-"))[2]; }

void write_pictures(const std::string& folder, const Study& study, const StudyPictures& plan) {
  const std::filesystem::path path = folder;
  WriteOptions shown_at;
  shown_at.exposure = plan.exposure;
  const WriteOptions as_they_are{false, 0.0, Tonemap::none};
  write_picture(path / kReferencePicture, study.reference.picture, {}, shown_at);
  if (study.occlusion) write_picture(path / kOcclusionPicture, study.occlusion->picture, {}, as_they_are);
  for (const Series& series : study.series) {
    const StudyPicture* shown = picture_near(series, plan.seconds);
    if (!shown) continue;
    const Picture map = error_map(shown->picture.width, shown->picture.height, shown->flip, plan.brightest);
    write_picture(path / picture_name(series), shown->picture, {}, series.shows_occlusion() ? as_they_are : shown_at);
    write_picture(path / map_name(series), map, {}, as_they_are);
    const std::optional<Picture>& shadows = shown->false_shadows;
    if (shadows && !shadows->channels.empty())
      write_picture(path / false_shadow_name(series), *shadows, {}, as_they_are);
  }
}

} // namespace wavepath
