// Writes the files of a study: study.json, study.csv, the reference, and the pictures and error maps that the page
// shows.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "host/study/study.h"

namespace wavepath {

struct StudyRecord {
  std::string scene, command, date; // as the user gave them; date: UTC
  std::string repeat;               // the part that the commands to repeat every row have in common
  std::string folder;
  const DeviceInfo& device;
  const StudySettings& settings;
  const Study& study;
};

nlohmann::ordered_json study_document(const StudyRecord& record);
std::string study_csv(const StudyRecord& record);

// Into the folder of the record, which is created if its parent is there. Each file is whole or not there.
void write_study(const StudyRecord& record);

} // namespace wavepath
