// Writes the files of a study: study.json, study.csv, the reference, and the pictures and error maps that the page
// shows.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/study.h"

namespace wavepath {

struct StudyRecord {
  std::string scene, command, date; // as the user gave them; date in UTC
  std::string repeat;               // the part that the commands to repeat every row have in common
  std::string folder;
  const DeviceInfo& device;
  const StudySettings& settings;
  const Study& study;
};

nlohmann::ordered_json study_document(const StudyRecord& record);
std::string study_csv(const StudyRecord& record);

inline constexpr const char* kReferenceFile = "reference.exr"; // name in the folder if no reference is given
// The files that a study of these configurations may write into `folder`.
std::vector<std::string> study_files(const std::string& folder, const std::vector<Configuration>& grid);

// Into the folder of the record, which is created if its parent is there. Each file is whole or not there, and written
// whatever becomes of the others.
void write_study(const StudyRecord& record);

} // namespace wavepath
