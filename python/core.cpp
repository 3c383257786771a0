// wavepath._core: the library of include/wavepath as Python sees it. What makes it pleasant is written in Python,
// beside.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <wavepath/wavepath.h>

namespace py = pybind11;
namespace wp = wavepath;

namespace {

// What the callbacks of a render threw, which must not pass through the library.
struct CallbackFailed {
  std::optional<py::error_already_set> error;
};

wp::Value value_of(const py::handle& object) {
  if (py::isinstance<py::bool_>(object)) return object.cast<bool>();
  if (py::isinstance<py::int_>(object)) return py::str(object).cast<std::string>();
  if (py::isinstance<py::float_>(object)) return object.cast<double>();
  if (py::isinstance<py::str>(object)) return object.cast<std::string>();
  std::vector<std::string> texts;
  for (const py::handle item : object) texts.push_back(value_of(item).texts.front());
  return texts;
}

wp::Settings settings_of(const py::dict& settings) {
  wp::Settings all;
  for (const auto& [name, value] : settings) all.set(name.cast<std::string>(), value_of(value));
  return all;
}

template <class Number>
py::array_t<Number> array_of(const wp::Result& result, const std::vector<std::string>& channels, bool flat) {
  std::vector<py::ssize_t> shape = {result.height(), result.width()};
  if (!flat || channels.size() != 1) shape.push_back(static_cast<py::ssize_t>(channels.size()));
  py::array_t<Number> array(shape);
  Number* data = array.mutable_data();
  const py::gil_scoped_release released;
  result.copy(channels, data);
  return array;
}

// Calls Python while a render is under way, which holds no lock of Python's. Signals are looked at here.
wp::Hooks hooks_of(const py::object& progress, const py::object& picture, double every, CallbackFailed& failed) {
  wp::Hooks hooks;
  const auto call = [&failed](const auto& function) {
    const py::gil_scoped_acquire acquired;
    try {
      if (PyErr_CheckSignals() != 0) throw py::error_already_set();
      return function();
    } catch (py::error_already_set& error) {
      failed.error.emplace(std::move(error));
    }
    return false;
  };
  hooks.progress = [=, &failed](const wp::Progress& p) {
    if (failed.error) return false;
    return call([&] { return progress.is_none() || !progress(p).is(py::bool_(false)); });
  };
  if (!picture.is_none()) {
    hooks.picture_seconds = every;
    hooks.picture = [=, &failed](const wp::Result& result) {
      if (!failed.error) call([&] { return picture(result), true; });
    };
  }
  return hooks;
}

// Renders without Python's lock. Returns the picture, and the exception of a callback that ended it early, or None.
template <class Render>
py::tuple render_released(const py::object& progress, const py::object& picture, double every, const Render& render) {
  CallbackFailed failed;
  const wp::Hooks hooks = hooks_of(progress, picture, every, failed);
  std::optional<wp::Result> result;
  {
    const py::gil_scoped_release released;
    result.emplace(render(hooks));
  }
  py::object thrown = py::none();
  if (failed.error) thrown = failed.error->value();
  return py::make_tuple(*result, thrown);
}

py::list names_of(const std::vector<wp::Named>& named) {
  py::list list;
  for (const wp::Named& one : named) list.append(one.name);
  return list;
}

const char* stop_name(wp::Stop stop) {
  switch (stop) {
    case wp::Stop::samples:
      return "samples";
    case wp::Stop::time:
      return "time";
    case wp::Stop::target_error:
      return "target-error";
    case wp::Stop::interrupted:
      return "interrupted";
    case wp::Stop::device_lost:
      return "device-lost";
  }
  return "";
}

void bind_errors(py::module_& m) {
  // Made in Python, where it has members; see errors.py.
  static py::object error_class, usage_class;
  m.def("_set_errors", [](py::object error, py::object usage) { error_class = error, usage_class = usage; });
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const wp::Error& error) {
      const py::object& type = dynamic_cast<const wp::UsageError*>(&error) ? usage_class : error_class;
      const py::object made = type(error.where(), error.problem(), error.remedy());
      PyErr_SetObject(type.ptr(), made.ptr());
    }
  });
}

void bind_values(py::module_& m) {
  py::class_<wp::DeviceInfo>(m, "DeviceInfo", "A Vulkan device of this machine.")
      .def_readonly("name", &wp::DeviceInfo::name)
      .def_readonly("driver", &wp::DeviceInfo::driver)
      .def_readonly("type", &wp::DeviceInfo::type)
      .def_readonly("missing", &wp::DeviceInfo::missing)
      .def("__repr__", [](const wp::DeviceInfo& info) { return "<" + info.name + " (" + info.type + ")>"; });
  py::class_<wp::Device>(m, "Device",
                         "An open Vulkan device, which scenes can share: by a part of its name, or its index.")
      .def(py::init([](const std::string& name) {
             const py::gil_scoped_release released;
             return wp::Device(name);
           }),
           py::arg("name") = "")
      .def_property_readonly("info", &wp::Device::info)
      .def("__repr__", [](const wp::Device& device) { return "wavepath.Device('" + device.info().name + "')"; });
  py::class_<wp::Progress>(m, "Progress", "How far a render is.")
      .def_readonly("spp", &wp::Progress::spp)
      .def_readonly("planned_spp", &wp::Progress::planned_spp)
      .def_readonly("fraction", &wp::Progress::fraction)
      .def_readonly("seconds", &wp::Progress::seconds)
      .def_readonly("error", &wp::Progress::error)
      .def_readonly("mrays_per_second", &wp::Progress::mrays_per_second);
}

void bind_result(py::module_& m) {
  py::class_<wp::Result>(m, "Result")
      .def_property_readonly("width", &wp::Result::width)
      .def_property_readonly("height", &wp::Result::height)
      .def_property_readonly("place",
                             [](const wp::Result& result) {
                               const wp::Result::Place place = result.place();
                               return py::make_tuple(place.left, place.top, place.whole_width, place.whole_height);
                             })
      .def_property_readonly("spp", &wp::Result::spp)
      .def_property_readonly("seconds", &wp::Result::seconds)
      .def_property_readonly("error", &wp::Result::error)
      .def_property_readonly("stop", [](const wp::Result& result) { return stop_name(result.stop()); })
      .def_property_readonly("channels", &wp::Result::channels)
      .def_property_readonly("stats_text", &wp::Result::stats)
      .def_property_readonly("warnings", &wp::Result::warnings)
      .def_property_readonly("repeat", &wp::Result::repeat)
      .def("channels_of", &wp::Result::channels_of)
      .def("text", &wp::Result::text)
      .def("floats", &array_of<float>, py::arg("channels"), py::arg("flat") = false)
      .def("ints", &array_of<std::int32_t>, py::arg("channels"), py::arg("flat") = false)
      .def("save",
           [](const wp::Result& result, const std::string& file, const py::dict& settings) {
             const wp::Settings all = settings_of(settings);
             const py::gil_scoped_release released;
             result.save(file, all);
           })
      .def("encode", [](const wp::Result& result, const std::string& format, const py::dict& settings) {
        const wp::Settings all = settings_of(settings);
        std::vector<std::uint8_t> bytes;
        {
          const py::gil_scoped_release released;
          bytes = result.encode(format, all);
        }
        return py::bytes(reinterpret_cast<const char*>(bytes.data()), bytes.size());
      });
}

// Releases a scene without Python's lock: another thread may hold the device, and wait for the lock in its callback.
struct HeldSession {
  explicit HeldSession(wp::Session opened) : session(std::move(opened)) {}
  ~HeldSession() {
    const py::gil_scoped_release released;
    session.reset();
  }
  HeldSession(const HeldSession&) = delete;

  std::optional<wp::Session> session;
};

// A method of the session, called without Python's lock.
template <class Return, class... Parameters>
auto released(Return (wp::Session::*method)(Parameters...)) {
  return [method](HeldSession& held, Parameters... arguments) {
    const py::gil_scoped_release lock;
    return ((*held.session).*method)(arguments...);
  };
}
template <class Return, class... Parameters>
auto released(Return (wp::Session::*method)(Parameters...) const) {
  return [method](const HeldSession& held, Parameters... arguments) {
    const py::gil_scoped_release lock;
    return ((*held.session).*method)(arguments...);
  };
}

using Floats = py::array_t<float, py::array::c_style | py::array::forcecast>;

std::vector<float> values_of(const Floats& array) { return {array.data(), array.data() + array.size()}; }

// Height x width x channels, of bytes or floats.
wp::Texels texels_of(const py::array& array) {
  wp::Texels texels;
  if (array.ndim() != 2 && array.ndim() != 3) throw py::value_error("an array of height x width x channels is needed");
  texels.height = static_cast<std::uint32_t>(array.shape(0));
  texels.width = static_cast<std::uint32_t>(array.shape(1));
  texels.channels = array.ndim() == 3 ? static_cast<std::uint32_t>(array.shape(2)) : 1;
  if (array.dtype().kind() == 'u' && array.itemsize() == 1) {
    const auto bytes = py::array_t<std::uint8_t, py::array::c_style>::ensure(array);
    texels.bytes = {bytes.data(), bytes.data() + bytes.size()};
  } else {
    const auto floats = Floats::ensure(array);
    if (!floats) throw py::error_already_set();
    texels.floats = values_of(floats);
  }
  return texels;
}

wp::MeshData mesh_of(const std::string& name, const Floats& vertices,
                     const py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>& faces,
                     const std::optional<Floats>& normals, const std::optional<Floats>& uvs, std::size_t material,
                     const wp::Matrix4& matrix) {
  wp::MeshData mesh;
  mesh.name = name;
  mesh.positions = values_of(vertices);
  mesh.indices = {faces.data(), faces.data() + faces.size()};
  if (normals) mesh.normals = values_of(*normals);
  if (uvs) mesh.uvs = values_of(*uvs);
  mesh.material = material;
  mesh.world_from_object = matrix;
  return mesh;
}

void bind_session(py::module_& m) {
  m.def("material_fields", &wp::Session::material_fields);
  m.def("material_textures", &wp::Session::material_textures);
  m.def("light_fields", &wp::Session::light_fields);
  py::class_<HeldSession>(m, "Session")
      .def(py::init([](const std::string& file, const py::dict& settings, const std::optional<wp::Device>& device) {
             const wp::Settings all = settings_of(settings);
             const py::gil_scoped_release lock;
             return std::make_unique<HeldSession>(wp::Session({file}, all, device));
           }),
           py::arg("file"), py::arg("settings"), py::arg("device") = py::none())
      .def("cameras", [](const HeldSession& held) { return names_of(held.session->cameras()); })
      .def("variants", [](const HeldSession& held) { return held.session->variants(); })
      .def("nodes", [](const HeldSession& held) { return names_of(held.session->nodes()); })
      .def("materials", [](const HeldSession& held) { return names_of(held.session->materials()); })
      .def("lights",
           [](const HeldSession& held) {
             std::vector<wp::Named> lights;
             {
               const py::gil_scoped_release lock;
               lights = held.session->lights();
             }
             py::list list;
             for (const wp::Named& light : lights) list.append(py::make_tuple(light.name, light.index));
             return list;
           })
      .def("light", released(&wp::Session::light))
      .def("set_light", released(&wp::Session::set_light))
      .def("bounds", released(&wp::Session::bounds))
      .def("device", [](const HeldSession& held) { return held.session->device(); })
      .def("material", released(&wp::Session::material))
      .def("set_material", released(&wp::Session::set_material))
      .def("add_material", released(&wp::Session::add_material))
      .def("set_texture",
           [](HeldSession& held, std::size_t material, const std::string& texture, const py::array& array) {
             const wp::Texels texels = texels_of(array);
             const py::gil_scoped_release lock;
             held.session->set_texture(material, texture, texels);
           })
      .def("matrix", released(&wp::Session::matrix))
      .def("set_matrix", released(&wp::Session::set_matrix))
      .def("reset_matrix", released(&wp::Session::reset_matrix))
      .def("is_visible", released(&wp::Session::is_visible))
      .def("set_visible", released(&wp::Session::set_visible))
      .def("add_mesh",
           [](HeldSession& held, const std::string& name, const Floats& vertices,
              const py::array_t<std::uint32_t, py::array::c_style | py::array::forcecast>& faces,
              const std::optional<Floats>& normals, const std::optional<Floats>& uvs, std::size_t material,
              const wp::Matrix4& matrix) {
             const wp::MeshData mesh = mesh_of(name, vertices, faces, normals, uvs, material, matrix);
             const py::gil_scoped_release lock;
             return held.session->add_mesh(mesh);
           })
      .def("remove_mesh", released(&wp::Session::remove_mesh))
      .def("set_environment",
           [](HeldSession& held, const Floats& radiance, double intensity, double degrees) {
             const wp::Texels texels = texels_of(radiance);
             const py::gil_scoped_release lock;
             held.session->set_environment(texels, intensity, degrees);
           })
      .def("update",
           [](HeldSession& held) {
             std::vector<wp::Redone> redone;
             {
               const py::gil_scoped_release lock;
               redone = held.session->update();
             }
             py::list list;
             for (const wp::Redone& part : redone) list.append(py::make_tuple(part.what, part.milliseconds));
             return list;
           })
      .def(
          "render",
          [](HeldSession& held, const py::dict& settings, const py::object& progress, const py::object& picture,
             double every) {
            const wp::Settings all = settings_of(settings);
            return render_released(progress, picture, every,
                                   [&](const wp::Hooks& hooks) { return held.session->render(all, hooks); });
          },
          py::arg("settings"), py::arg("progress") = py::none(), py::arg("picture") = py::none(),
          py::arg("every") = 1.0);
}

wp::Pixels pixels_of(const Floats& array) {
  wp::Texels texels = texels_of(array);
  if (texels.channels != 3) throw py::value_error("an array of height x width x 3 is needed");
  return {texels.width, texels.height, std::move(texels.floats)};
}

void bind_compare(py::module_& m) {
  m.def("read", [](const std::string& file) {
    const py::gil_scoped_release released;
    return wp::read(file);
  });
  m.def("compare", [](const Floats& image, const Floats& reference) {
    const wp::Pixels a = pixels_of(image), b = pixels_of(reference);
    const py::gil_scoped_release released;
    return wp::compare(a, b);
  });
}

// Settings of a camera with this pose.
py::dict camera_settings(const wp::Matrix4& world_from_camera, const std::optional<wp::Matrix3>& k, bool opencv) {
  const wp::Camera camera =
      wp::Camera::from_matrix(world_from_camera, k, opencv ? wp::AxesOfCamera::opencv : wp::AxesOfCamera::opengl);
  py::dict settings;
  settings["eye"] = *camera.eye;
  settings["look_at"] = *camera.look_at;
  settings["up"] = *camera.up;
  if (camera.intrinsics) settings["intrinsics"] = *camera.intrinsics;
  return settings;
}

} // namespace

PYBIND11_MODULE(_core, m) {
  m.doc() = "The library of wavepath; use the module wavepath.";
  bind_errors(m);
  bind_values(m);
  bind_result(m);
  bind_session(m);
  bind_compare(m);
  m.attr("version") = wp::version();
  m.def("camera_settings", &camera_settings);
  m.def(
      "devices",
      [] {
        const py::gil_scoped_release released;
        return wp::devices();
      },
      "All devices of this machine, in the order of their indices.");
  m.def(
      "render",
      [](const std::string& file, const py::dict& settings, const py::object& progress, const py::object& picture,
         double every) {
        const wp::Settings all = settings_of(settings);
        return render_released(progress, picture, every,
                               [&](const wp::Hooks& hooks) { return wp::render({file}, all, hooks); });
      },
      py::arg("file"), py::arg("settings"), py::arg("progress") = py::none(), py::arg("picture") = py::none(),
      py::arg("every") = 1.0);
  m.def("command", [](const std::vector<std::string>& words) {
    wp::Printed printed;
    {
      const py::gil_scoped_release released;
      printed = wp::command(words);
    }
    return py::make_tuple(printed.out, printed.err, printed.exit_code);
  });
  m.def("command_line", [](const std::vector<std::string>& words) {
    std::vector<const char*> arguments;
    for (const std::string& word : words) arguments.push_back(word.c_str());
    const py::gil_scoped_release released;
    return wp::command_line(static_cast<int>(arguments.size()), arguments.data());
  });
}
