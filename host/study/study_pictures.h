// The pictures that the page of a study shows: every configuration at equal time, and where it is wrong.
#pragma once

#include <string>
#include <vector>

#include "host/study/study.h"

namespace wavepath {

struct StudyPictures {
  double seconds = 0.0;   // the time that all are nearest to
  double exposure = 0.0;  // stops that bring the reference's mean to a middle grey, whatever light the scene has
  double brightest = 1.0; // FLIP from which on the maps are brightest: all but a hundredth of their pixels stay below
};
StudyPictures plan_pictures(const Study& study);

// Names within the folder of the study.
inline constexpr const char* kReferencePicture = "pictures/reference.png";
inline constexpr const char* kOcclusionPicture = "pictures/ao-reference.png";
// File names for one configuration: the picture, its error map, its false shadows.
std::vector<std::string> picture_names(const std::string& configuration);
std::string picture_name(const Series& series);
std::string map_name(const Series& series);
std::string false_shadow_name(const Series& series);

// Into a folder that has one called pictures.
void write_pictures(const std::string& folder, const Study& study, const StudyPictures& plan);

} // namespace wavepath
