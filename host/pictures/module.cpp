// The one symbol of the module.
#include "host/images/picture_module.h"
#include "host/pictures/radiance.h"
#include "host/pictures/reader.h"

extern "C" __attribute__((visibility("default"))) const wavepath::PictureModule* wavepath_pictures() {
  static const wavepath::PictureModule module{wavepath::read_by_openimageio, wavepath::encode_radiance_by_openimageio};
  return &module;
}
