// Parts of pictures: cuts one out of a larger picture, and puts one into it.
#pragma once

#include <optional>

#include "host/picture/picture.h"

namespace wavepath {

// The pixels of `picture` that `part` shows; empty if `picture` lacks some of them, or is of another size.
std::optional<Picture> cut_to(const Picture& picture, const Picture& part);

// Copies the channels of `part` into a picture that holds its pixels. Channels that the picture lacks begin with zeros.
void paste(const Picture& part, Picture& picture);

} // namespace wavepath
