// The one symbol of the module.
#include "host/codecs/openimageio/radiance.h"
#include "host/codecs/openimageio/reader.h"
#include "host/codecs/picture_module.h"

extern "C" __attribute__((visibility("default"))) const wavepath::PictureModule* wavepath_pictures() {
  static const wavepath::PictureModule module{wavepath::read_by_openimageio, wavepath::encode_radiance_by_openimageio};
  return &module;
}
