// Times of a shadow technique in each frame: building its data, and looking shadows up.
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
