// wavepath: reference images of glTF scenes. Docs: docs/library.md.
//
//     wavepath::Session session({"room.glb"});
//     wavepath::Result picture = session.render({{"spp", 16}, {"size", "640x360"}});
//     picture.save("room.exr");
#pragma once

#include <wavepath/camera.h>
#include <wavepath/command.h>
#include <wavepath/compare.h>
#include <wavepath/device.h>
#include <wavepath/error.h>
#include <wavepath/result.h>
#include <wavepath/scene.h>
#include <wavepath/session.h>
#include <wavepath/settings.h>
#include <wavepath/version.h>
