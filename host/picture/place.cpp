#include "host/picture/place.h"

#include <algorithm>

namespace wavepath {
namespace {

PicturePlace known_place(const Picture& picture) {
  const PicturePlace& place = picture.place;
  return place.whole_width > 0 ? place : PicturePlace{0, 0, picture.width, picture.height};
}

// Calls body(first value of a row in `picture`, that in `part`) for the rows of `part`.
template <class Body>
void for_rows(const Picture& picture, const Picture& part, Body body) {
  const PicturePlace from = known_place(picture), to = known_place(part);
  for (std::size_t y = 0; y < part.height; ++y)
    body((y + to.top - from.top) * picture.width + to.left - from.left, y * part.width);
}

} // namespace

std::optional<Picture> cut_to(const Picture& picture, const Picture& part) {
  const PicturePlace from = known_place(picture), to = known_place(part);
  if (from.whole_width != to.whole_width || from.whole_height != to.whole_height || to.left < from.left ||
      to.top < from.top || to.left + part.width > from.left + picture.width ||
      to.top + part.height > from.top + picture.height)
    return std::nullopt;
  Picture result{part.width, part.height, {}, picture.display, picture.texts, part.place};
  for (const Channel& channel : picture.channels) {
    Channel& own = result.channels.emplace_back(Channel{channel.name, {}});
    own.values.resize(std::size_t{part.width} * part.height);
    for_rows(picture, part, [&](std::size_t first, std::size_t at) {
      std::copy_n(&channel.values[first], part.width, &own.values[at]);
    });
  }
  return result;
}

void paste(const Picture& part, Picture& picture) {
  for (const Channel& channel : part.channels) {
    auto there = std::ranges::find(picture.channels, channel.name, &Channel::name);
    if (there == picture.channels.end()) {
      picture.channels.push_back({channel.name, std::vector<float>(std::size_t{picture.width} * picture.height)});
      there = picture.channels.end() - 1;
    }
    for_rows(picture, part, [&](std::size_t first, std::size_t at) {
      std::copy_n(&channel.values[at], part.width, &there->values[first]);
    });
  }
}

} // namespace wavepath
