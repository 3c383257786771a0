// Reads photometric files of luminaires: IES LM-63-1995, -2002, -2019, and older ones.
#pragma once

#include <string>
#include <string_view>

#include "host/scene/scene.h"

namespace wavepath {

struct IesFile {
  LightProfile profile; // without a name
  double candela = 0.0; // of intensity 1, ballast factor and multiplier included; 0: the luminaire is dark
  char type = 'C';      // of photometry; of types A and B nothing else is read
};

// `text`: the contents of a file; `file` and `what` name it in messages. Throws Error.
IesFile read_ies(const std::string& file, const std::string& what, std::string_view text);

} // namespace wavepath
