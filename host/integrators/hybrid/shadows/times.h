// What a shadow technique takes, frame by frame: to build what it looks shadows up in, and to look them up.
#pragma once

#include "host/render/loop/frame_times.h"

namespace wavepath {

inline constexpr const char *kShadowBuildStage = "shadow build", *kShadowLookUpStage = "shadow look-up";

struct ShadowTimes {
  FrameTimes build{kShadowBuildStage}, look_up{kShadowLookUpStage};

  void note_frame(const Totals& totals) {
    build.note_frame(totals);
    look_up.note_frame(totals);
  }
};

} // namespace wavepath
