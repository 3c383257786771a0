// Notes edits, finds out what they touch, and has only that packed and uploaded; see session.h.
#include "host/session/session.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/base/process_clock.h"
#include "host/gpu/pipeline_cache.h"
#include "host/plan/bvh_quality.h"
#include "host/render/denoised.h"
#include "host/render/progressive/progressive.h"
#include "host/render/report/diagnosis.h"
#include "host/render/report/stats.h"
#include "host/render/settings/pass_names.h"
#include "host/render/settings/traversal.h"
#include "host/render/workspace/device_scene.h"
#include "host/scene/pack/cut_scene.h"
#include "host/scene/pack/pack_memory.h"
#include "host/scene/pack/plan.h"
#include "host/session/finish.h"
#include "host/session/load.h"
#include "host/session/prepare.h"
#include "host/session/repeat.h"
#include "host/session/run.h"

namespace wavepath {
namespace {

bool is_affine(const glm::dmat4& matrix) {
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row)
      if (!std::isfinite(matrix[column][row])) return false;
  return glm::dvec4(matrix[0][3], matrix[1][3], matrix[2][3], matrix[3][3]) == glm::dvec4(0.0, 0.0, 0.0, 1.0);
}

bool has_shape(const glm::dmat4& matrix) {
  const double determinant = glm::determinant(glm::dmat3(matrix));
  return std::isfinite(determinant) && determinant != 0.0 && std::isfinite(1.0 / determinant);
}

void check_index(const Scene& scene, const char* what, std::size_t index, std::size_t count) {
  if (index >= count)
    throw Error(scene.path, fmt::format("has no {} {}", what, index),
                count ? fmt::format("give a number up to {}", count - 1) : "add one first");
}

// Neither negative nor infinite, nor not-a-number, which no comparison holds for.
bool is_radiance(std::span<const glm::vec3> values) {
  const auto check = [&](const tbb::blocked_range<std::size_t>& range, bool sound) {
    for (const glm::vec3& v : values.subspan(range.begin(), range.size()))
      for (int c = 0; c < 3; ++c) sound &= v[c] >= 0.0f && v[c] <= std::numeric_limits<float>::max();
    return sound;
  };
  return tbb::parallel_reduce(tbb::blocked_range<std::size_t>(0, values.size(), 1 << 16), true, check,
                              std::logical_and<bool>());
}

// What meshes carry for a material: an edit that asks for more has the meshes read again.
bool reads_more(const Material& before, const Material& after) {
  bool sets[2][2] = {};
  const Material* both[2] = {&before, &after};
  for (int i = 0; i < 2; ++i) {
    visit_textures(*both[i], [&](const MaterialTexture&, const TextureSlot& slot) { sets[i][slot.uv_set & 1] = true; });
    if (needs_tangents(*both[i])) sets[i][tangent_slot(*both[i]).uv_set & 1] = true;
  }
  const auto same = [](const TextureSlot& a, const TextureSlot& b) {
    return a.uv_set == b.uv_set && a.uv_matrix == b.uv_matrix;
  };
  const bool turns = needs_tangents(after) &&
                     (!needs_tangents(before) || !same(tangent_slot(before), tangent_slot(after)) ||
                      !same(layer_tangent_slot(before, kCoatTangents), layer_tangent_slot(after, kCoatTangents)) ||
                      !same(layer_tangent_slot(before, kGrainTangents), layer_tangent_slot(after, kGrainTangents)));
  return turns || (sets[1][0] && !sets[0][0]) || (sets[1][1] && !sets[0][1]);
}

void check_material(const Scene& scene, const Material& material) {
  visit_textures(material, [&](const MaterialTexture& row, const TextureSlot& slot) {
    if (slot.image >= scene.images.size())
      throw Error(row.name, fmt::format("names image {}, of which there are {}", slot.image, scene.images.size()),
                  "add the image first");
    if (slot.uv_set > 1) throw Error(row.name, "reads a third set of texture coordinates", "use set 0 or 1");
  });
}

void check_light(const PunctualLight& light) {
  const auto require = [&](bool holds, const char* problem, const char* remedy) {
    if (!holds) throw Error(light.name.empty() ? "light" : light.name, problem, remedy);
  };
  const auto in = [](double value, double low, double high) { return value >= low && value <= high; };
  const glm::vec3& intensity = light.intensity;
  require(in(intensity.x, 0.0, 1e30) && in(intensity.y, 0.0, 1e30) && in(intensity.z, 0.0, 1e30),
          "has an intensity that is negative or not finite", "give 0 to 1e30");
  require(in(light.range, 0.0, 1e30), "has a range that is negative or not finite", "give metres, or 0 for none");
  require(in(light.outer_cone, 0.0, 0.5 * std::numbers::pi) && in(light.inner_cone, 0.0, light.outer_cone),
          "has cones that are not in order", "give 0 <= inner <= outer <= 90 degrees");
  if (light.kind == LightKind::directional)
    require(in(light.extent, 0.0, 0.5 * std::numbers::pi), "is seen under no such angle", "give 0 to 180 degrees");
  else
    require(in(light.extent, 0.0, 1e9), "has no such radius", "give 0 to 1e9 metres");
}

void check_image(const Image& image) {
  const std::size_t values = 4 * std::size_t{image.width} * image.height;
  if (values == 0 || (image.bytes.size() != values && image.floats.size() != values) ||
      (!image.bytes.empty() && !image.floats.empty()))
    throw Error(image.name.empty() ? "image" : image.name,
                fmt::format("does not hold four channels of {}x{} texels", image.width, image.height),
                "give as many bytes or floats");
}

void check_mesh(const Scene& scene, const Mesh& mesh) {
  const auto refuse = [&](const std::string& problem, const char* remedy) {
    throw Error(mesh.name.empty() ? "mesh" : mesh.name, problem, remedy);
  };
  const std::size_t vertices = mesh.positions.size();
  const auto check = [&](const auto& values, const char* what) {
    if (!values.empty() && values.size() != vertices)
      refuse(fmt::format("has {} {} for {} vertices", values.size(), what, vertices), "give one for each vertex");
  };
  check(mesh.normals, "normals"), check(mesh.tangents, "tangents"), check(mesh.colors, "colours");
  check(mesh.uvs[0], "texture coordinates"), check(mesh.uvs[1], "texture coordinates");
  for (const std::uint32_t index : mesh.indices)
    if (index >= vertices) refuse(fmt::format("names vertex {} of {}", index, vertices), "give lower indices");
  for (const Primitive& primitive : mesh.primitives) {
    if (std::size_t{primitive.first_index} + primitive.index_count > mesh.indices.size())
      refuse("has a primitive beyond its indices", "give a range within them");
    if (primitive.material >= scene.materials.size())
      refuse(fmt::format("names material {} of {}", primitive.material, scene.materials.size()),
             "add the material first");
    if (primitive.has_normals && mesh.normals.empty()) refuse("lacks the normals that it says it has", "give them");
  }
  if (mesh.moves()) refuse("moves while the shutter is open", "leave out its ends");
}

} // namespace

struct Session::State {
  SessionRequest request;
  LoadedScene loaded;
  Prepared prepared;
  PackMemory memory;
  std::shared_ptr<DeviceScene> on_device; // of what memory knows; null before the first
  glm::dvec3 eye{0.0};                    // around which single precision is finest
  std::optional<bvh::Quality> quality;    // of the first tree
  std::optional<Packing> packed_as;       // empty before the first
  std::size_t file_nodes = 0;
  bool is_edited = false; // no command tells the edits

  // The render that the caller steps; null before begin().
  std::unique_ptr<Progressive> stepped;
  std::function<void()> lets_go;
  bool is_handed = false; // `stepped` has the scene as it is packed
  bool other_settings = false, other_view = false;

  // The lighting that update() has done last, where another one is noted.
  std::optional<Lighting> lit;
  EnvironmentRequest lit_by;

  // Edits that poses do not keep.
  std::map<std::size_t, Material> materials;
  std::vector<Material> added_materials;
  std::map<std::uint32_t, PunctualLight> lights; // by node
  std::map<std::size_t, AddedMesh> meshes;       // by node
  std::vector<std::string> added_nodes;          // names

  // What update() has to do.
  bool poses = false, moves = false; // the file is posed again; instances are not where they were
  bool other_materials = false, other_images = false, other_environment = false;
  bool is_posed = false, is_posed_else = false; // since it was packed; and instances or vertices are elsewhere
  bool other_motion = false;                    // prepared.motion is not that of the request
  glm::uvec2 motion_size{0};                    // of the picture that it is of

  Scene& scene() { return loaded.scene; }
  void require_edits(SessionUse least = SessionUse::edits) const;
  void add_all();
  void change_lights();
  bool pose_as(const SceneRequest& moment);
  bool is_pose_due(const RenderPlan& settings) const;
  void pose(const RenderPlan& settings);
  bool is_packed(Packing wanted);
  SessionUpdate bring(const RenderRequest& request);
  Packing pack(const RenderRequest& render);
  void upload(const RenderRequest& render);
  void hand_over();
  void note(Lighting before);
  template <class Change>
  void without_added(const Change& change);
};

void Session::State::require_edits(SessionUse least) const {
  if (request.use < least)
    throw Error(loaded.scene.path, "was opened without room for edits", "open a session with SessionUse::edits");
}

void Session::State::change_lights() {
  for (PunctualLight& light : scene().lights) {
    const auto found = lights.find(light.node);
    if (found == lights.end()) continue;
    const PunctualLight& edit = found->second;
    light.intensity = edit.intensity;
    light.inner_cone = edit.inner_cone, light.outer_cone = edit.outer_cone;
    light.range = edit.range, light.extent = edit.extent;
  }
}

// What is no part of the file, behind what is.
void Session::State::add_all() {
  Scene& all = scene();
  all.materials.insert(all.materials.end(), added_materials.begin(), added_materials.end());
  for (const auto& [index, material] : materials) all.materials[index] = material;
  change_lights();
  all.node_names.insert(all.node_names.end(), added_nodes.begin(), added_nodes.end());
  for (const auto& [node, added] : meshes) {
    if (!added.is_visible) continue;
    all.meshes.push_back(added.mesh);
    all.instances.push_back(
        {static_cast<std::uint32_t>(all.meshes.size() - 1), added.world_from_object, static_cast<std::uint32_t>(node)});
  }
}

// Returns whether every vertex of the file is where it was.
bool Session::State::pose_as(const SceneRequest& moment) {
  const bool is_still = pose_again(moment, loaded);
  add_all();
  return is_still;
}

bool Session::State::is_pose_due(const RenderPlan& settings) const {
  const MotionRequest& motion = request.motion;
  const bool is_told = motion.next.given() || motion.previous.given();
  return poses || other_motion || (is_told && motion_size != glm::uvec2(settings.width, settings.height));
}

// Poses the scene, and notes where motion goes to.
void Session::State::pose(const RenderPlan& settings) {
  if (!is_pose_due(settings)) return;
  if (poses) {
    const bool is_still = pose_as(request.scene);
    if (!loaded.file->keeps_materials()) other_materials = other_images = true;
    is_posed = true;
    is_posed_else |= !is_still || moves;
    poses = moves = false;
  }
  const MotionRequest& motion = request.motion;
  other_motion = true; // until all of it is there
  is_posed |= motion.next.at || motion.previous.at;
  const PoseScene at_moment = [this](const SceneRequest& moment) { return pose_as(moment); };
  is_posed_else |= !pose_others(request.scene, settings, motion, at_moment, loaded, prepared);
  other_motion = false;
  motion_size = {settings.width, settings.height};
}

// The ground's material is the last one for who lights the scene anew; edits of materials and lights come after that.
template <class Change>
void Session::State::without_added(const Change& change) {
  std::vector<Material>& all = scene().materials;
  all.resize(all.size() - added_materials.size());
  const auto put_back = [&] {
    all.insert(all.end(), added_materials.begin(), added_materials.end());
    for (const auto& [index, material] : materials) all[index] = material;
    change_lights();
  };
  try {
    change();
  } catch (...) {
    put_back();
    throw;
  }
  put_back();
}

// Whether the scene as it stands is packed so.
bool Session::State::is_packed(Packing wanted) {
  // `auto` has packed it likewise.
  if (packed_as && packed_as->lights == gpu::kLightsAuto && wanted.lights == usual_lights(prepared.packed))
    wanted.lights = gpu::kLightsAuto;
  if (!packed_as || is_posed || other_materials || other_images || other_environment ||
      !packs_alike(wanted, *packed_as))
    return false;
  if (wanted.near == packed_as->near) return true;
  return prepared.packed.cut.triangles == 0 &&
         count_pieces(loaded.scene, find_usage(loaded.scene), wanted.near).triangles == 0;
}

Packing Session::State::pack(const RenderRequest& render) {
  Packing packing;
  if (request.use == SessionUse::one_picture) {
    if (prepared.memory) require_edits();
    loaded.file.reset();
    packing = pack_scene(request.scene, render, loaded, prepared, nullptr);
    scene().images = {}; // rendering needs the packed one
    scene().meshes = {};
    scene().instances = {};
    scene().environment = {};
  } else {
    memory.other_materials = other_materials || (other_environment && request.scene.ground);
    memory.other_images = other_images;
    memory.other_environment = other_environment;
    memory.keeps_trees = request.use >= SessionUse::poses;
    memory.packed = std::move(prepared.packed);
    packing = pack_scene(request.scene, render, loaded, prepared, &memory);
  }
  quality = prepared.packed.bvh_quality;
  return packing;
}

void Session::State::upload(const RenderRequest& render) {
  if (request.use == SessionUse::one_picture) return; // the first render does it
  prepared.on_device = {};
  if (!prepared.others.empty()) return; // each device uploads by itself
  const Clock::time_point start = Clock::now();
  Device& device = *prepared.device;
  const bool by_query = traces_by_query(traversal_of(render.settings), device.info());
  const bool is_first = !on_device;
  DeviceScene before = is_first ? DeviceScene{} : std::move(*on_device);
  on_device.reset();
  on_device = std::make_shared<DeviceScene>(
      upload_next_scene(device, prepared.packed, by_query, std::move(before), is_first ? KeptParts{} : memory.kept));
  prepared.on_device.scene = on_device;
  prepared.on_device.keeps_loop = true;
  prepared.on_device.upload_seconds = seconds_since(start);
}

// Hands the render that is stepped what it lacks.
void Session::State::hand_over() {
  if (!stepped) return;
  const RenderPlan& settings = request.render.settings;
  const View view = resolve_view(loaded.scene, loaded.framing, request.scene.view, settings.width, settings.height);
  try {
    if (!is_handed)
      stepped->set_scene(prepared.packed, view, settings, on_device);
    else if (other_settings)
      stepped->set_settings(settings, view);
    else if (other_view)
      stepped->move(view);
  } catch (...) { // between two settings it may lack buffers
    stepped->release();
    is_handed = false;
    throw;
  }
  is_handed = true;
  other_settings = other_view = false;
}

void Session::State::note(Lighting before) {
  other_environment = true;
  if (lit) return;
  lit = std::move(before);
  lit_by = environment_of(request.scene);
}

// Poses, packs and uploads what is not as it should be.
SessionUpdate Session::State::bring(const RenderRequest& given) {
  SessionUpdate update;
  const Clock::time_point start = Clock::now();
  auto told = [&, last = start](const char* what) mutable {
    const Clock::time_point now = Clock::now();
    update.redone.push_back({what, std::chrono::duration<double, std::milli>(now - last).count()});
    last = now;
  };
  RenderRequest render = given;
  render.origin = eye;
  if (!render.bvh) render.bvh = quality;
  try {
    const bool is_first = !prepared.memory;
    const RenderPlan& settings = render.settings;
    if (is_pose_due(settings)) {
      pose(settings);
      told("pose");
    }
    prepared.view = resolve_view(loaded.scene, loaded.framing, request.scene.view, settings.width, settings.height);
    if (request.keeps_cut && !prepared.cut_near) prepared.cut_near = prepared.view.position;
    update.kept_surfaces = update.kept_geometry = update.kept_shapes = true;
    if (!packed_as || !is_packed(packing_of(render, loaded.scene, prepared))) {
      if (stepped) {
        if (lets_go) lets_go();
        stepped->release();
        is_handed = false;
      }
      memory.is_still = packed_as.has_value() && !is_posed_else;
      packed_as.reset();
      const Packing packing = pack(render);
      told("pack");
      update.kept_surfaces = memory.kept.surfaces;
      update.kept_geometry = memory.kept.geometry;
      update.kept_shapes = memory.kept.geometry || memory.kept.places;
      const double seconds = seconds_since(start) - prepared.packed.bvh_seconds;
      prepared.load_seconds = is_first ? prepared.load_seconds + seconds : seconds;
      upload(render);
      told("upload");
      other_materials = other_images = other_environment = is_posed = is_posed_else = false;
      packed_as = packing;
      update.built_triangles = memory.trees.built;
    }
  } catch (...) { // what was taken over is lost
    memory = {};
    is_posed_else = true;
    on_device.reset();
    prepared.on_device = {};
    packed_as.reset();
    throw;
  }
  hand_over();
  lit.reset();
  update.milliseconds = 1e3 * seconds_since(start);
  return update;
}

Session::Session(const SessionRequest& request) : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.request = request;
  s.request.window_extensions = {};
  s.request.device = {};
  s.request.scene.load.keeps_hidden = request.use == SessionUse::edits;
  const Clock::time_point start = Clock::now();
  s.other_motion = request.motion.next.given() || request.motion.previous.given();
  const bool poses = request.use >= SessionUse::poses || request.motion.next.at || request.motion.previous.at;
  const bool stays_open = poses || request.use == SessionUse::light; // for its variants
  s.prepared = open(s.request.scene, request.render, s.loaded, stays_open, request.device, request.window_extensions);
  s.prepared.load_seconds = seconds_since(start);
  if (!poses && s.scene().variants.empty()) s.loaded.file.reset();
  s.file_nodes = s.scene().node_names.size();
  const RenderPlan& settings = request.render.settings;
  s.eye = request.render.origin.value_or(view(settings.width, settings.height).position);
  s.quality = request.render.bvh;
}

Session::~Session() = default;

const Scene& Session::scene() const { return state_->loaded.scene; }
const PackedScene& Session::packed() const { return state_->prepared.packed; }
const DeviceInfo& Session::device_info() const { return state_->prepared.device->info(); }
SessionDevice Session::device() const { return {state_->prepared.device, state_->prepared.kernels}; }
const std::string& Session::light() const { return state_->loaded.light; }
Prepared& Session::prepared() { return state_->prepared; }
LoadedScene& Session::loaded() { return state_->loaded; }
const SceneRequest& Session::scene_request() const { return state_->request.scene; }

View Session::view(std::uint32_t width, std::uint32_t height) const {
  return resolve_view(state_->loaded.scene, state_->loaded.framing, state_->request.scene.view, width, height);
}

void Session::set_origin(const std::optional<glm::dvec3>& origin) {
  const RenderPlan& settings = state_->request.render.settings;
  state_->eye = origin.value_or(view(settings.width, settings.height).position);
}

void Session::set_view(const ViewRequest& view) {
  check_camera(view, state_->request.render.settings);
  state_->request.scene.view = view;
  state_->other_view = true;
  const MotionRequest& motion = state_->request.motion;
  state_->other_motion |= motion.next.given() || motion.previous.given();
}

void Session::set_moment(double at, std::optional<std::pair<double, double>> shutter) {
  LoadOptions& load = state_->request.scene.load;
  if (load.at == at && load.shutter == shutter) return;
  state_->require_edits(SessionUse::poses);
  load.at = at;
  load.shutter = shutter;
  state_->poses = true;
}

void Session::set_variant(const std::string& name) {
  State& s = *state_;
  if (s.request.scene.load.variant == name) return;
  s.require_edits(SessionUse::light);
  const std::vector<std::string>& all = s.scene().variants;
  if (!name.empty() && std::ranges::find(all, name) == all.end())
    throw Error(s.scene().path, fmt::format("has no variant '{}'", name),
                all.empty() ? "it has no variants" : fmt::format("choose one of '{}'", fmt::join(all, "', '")));
  s.request.scene.load.variant = name;
  s.poses = s.other_materials = true;
}

void Session::set_motion(const MotionRequest& motion) {
  State& s = *state_;
  const RenderPlan& settings = s.request.render.settings;
  if (motion.next.at || motion.previous.at) s.require_edits(SessionUse::poses);
  for (const OtherMoment* other : {&motion.next, &motion.previous})
    if (other->camera)
      resolve_view(s.loaded.scene, s.loaded.framing, other_view(s.request.scene.view, *other), settings.width,
                   settings.height);
  s.request.motion = motion;
  s.other_motion = true;
}

void Session::set_environment(const EnvironmentRequest& environment) {
  State& s = *state_;
  s.require_edits(SessionUse::light);
  SceneRequest wanted = s.request.scene;
  wanted.environment = environment.source;
  wanted.environment_intensity = environment.intensity;
  wanted.environment_degrees = environment.degrees;
  s.without_added([&] { s.note(relight(wanted, s.loaded)); });
  s.request.scene = wanted;
}

void Session::set_environment(Environment environment) {
  State& s = *state_;
  s.require_edits(SessionUse::light);
  const std::size_t texels = std::size_t{environment.width} * environment.height;
  if (environment.map.size() != texels)
    throw Error("environment", fmt::format("does not hold {}x{} texels", environment.width, environment.height),
                "give as many");
  if (!is_radiance({&environment.radiance, 1}) || !is_radiance(environment.map))
    throw Error("environment", "has a radiance that is negative or not finite", "give finite values of zero or more");
  s.without_added([&] { s.note(relight(s.request.scene, {std::move(environment)}, s.loaded)); });
  s.is_edited = true;
}

void Session::reset_environment() {
  State& s = *state_;
  if (!s.lit) return;
  SceneRequest& asked = s.request.scene;
  s.without_added([&] { relight(asked, *std::move(s.lit), s.loaded); });
  asked.environment = s.lit_by.source;
  asked.environment_intensity = s.lit_by.intensity;
  asked.environment_degrees = s.lit_by.degrees;
  s.lit.reset();
  s.other_environment = !s.other_environment; // not packed yet, or packed in vain
}

void Session::set_material(std::size_t index, const Material& value) {
  State& s = *state_;
  s.require_edits();
  check_index(s.scene(), "material", index, s.scene().materials.size());
  check_material(s.scene(), value);
  Material& material = s.scene().materials[index];
  if (reads_more(material, value)) {
    s.loaded.file->forget_meshes();
    s.poses = true;
  }
  material = value;
  s.poses |= s.scene().end_catcher > s.scene().first_catcher; // its materials are copies of the file's
  const std::size_t first_added = s.scene().materials.size() - s.added_materials.size();
  if (index >= first_added)
    s.added_materials[index - first_added] = value;
  else
    s.materials[index] = value;
  s.other_materials = s.is_edited = true;
}

std::size_t Session::add_material(const Material& value) {
  State& s = *state_;
  s.require_edits();
  check_material(s.scene(), value);
  s.added_materials.push_back(value);
  s.scene().materials.push_back(value);
  s.other_materials = s.is_edited = true;
  return s.scene().materials.size() - 1;
}

void Session::set_light(std::uint32_t node, const PunctualLight& value) {
  State& s = *state_;
  s.require_edits();
  if (s.poses) pose(); // nodes may show other lights
  const auto light = std::ranges::find(s.scene().lights, node, &PunctualLight::node);
  if (light == s.scene().lights.end())
    throw Error(node == kNoIndex ? "light" : fmt::format("node {}", node), "shows no light", "name one that does");
  check_light(value);
  s.lights[node] = value;
  s.change_lights();
  s.is_posed = s.is_edited = true;
}

void Session::set_image(std::size_t index, Image value) {
  State& s = *state_;
  s.require_edits();
  check_index(s.scene(), "image", index, s.scene().images.size());
  check_image(value);
  s.scene().images[index] = std::move(value);
  s.other_images = s.is_edited = true;
}

std::size_t Session::add_image(Image value) {
  State& s = *state_;
  s.require_edits();
  check_image(value);
  s.scene().images.push_back(std::move(value));
  return s.scene().images.size() - 1;
}

void Session::set_matrix(std::size_t node, const glm::dmat4& parent_from_node) {
  State& s = *state_;
  s.require_edits();
  check_index(s.scene(), "node", node, s.scene().node_names.size());
  if (!is_affine(parent_from_node))
    throw Error(fmt::format("node {}", node), "has a matrix that is not affine or not finite",
                "give 0,0,0,1 as its last row, and finite numbers");
  if (node < s.file_nodes) {
    if (s.loaded.file->matrix(node) == parent_from_node) return;
    s.loaded.file->set_matrix(node, parent_from_node);
  } else {
    const auto found = s.meshes.find(node);
    if (found == s.meshes.end()) throw Error(fmt::format("node {}", node), "was removed", "name another one");
    if (!has_shape(parent_from_node))
      throw Error(fmt::format("node {}", node), "has a matrix that flattens it", "give one that can be inverted");
    if (found->second.world_from_object == parent_from_node) return;
    found->second.world_from_object = parent_from_node;
    s.moves = true;
  }
  s.poses = s.is_edited = true;
}

void Session::reset_matrix(std::size_t node) {
  State& s = *state_;
  s.require_edits();
  check_index(s.scene(), "node", node, s.file_nodes);
  s.loaded.file->set_matrix(node, std::nullopt);
  s.poses = true;
}

glm::dmat4 Session::matrix(std::size_t node) const {
  const State& s = *state_;
  check_index(s.loaded.scene, "node", node, s.loaded.scene.node_names.size());
  if (node < s.file_nodes) return s.loaded.file ? s.loaded.file->matrix(node) : glm::dmat4(1.0);
  const auto found = s.meshes.find(node);
  return found == s.meshes.end() ? glm::dmat4(1.0) : found->second.world_from_object;
}

void Session::set_visible(std::size_t node, bool is_visible) {
  State& s = *state_;
  s.require_edits();
  check_index(s.scene(), "node", node, s.scene().node_names.size());
  if (this->is_visible(node) == is_visible) return;
  if (node < s.file_nodes) {
    s.loaded.file->set_visible(node, is_visible);
  } else {
    const auto found = s.meshes.find(node);
    if (found == s.meshes.end()) throw Error(fmt::format("node {}", node), "was removed", "name another one");
    found->second.is_visible = is_visible;
  }
  s.poses = s.moves = s.is_edited = true;
}

bool Session::is_visible(std::size_t node) const {
  const State& s = *state_;
  check_index(s.loaded.scene, "node", node, s.loaded.scene.node_names.size());
  if (node < s.file_nodes) return s.loaded.file ? s.loaded.file->is_visible(node) : true;
  const auto found = s.meshes.find(node);
  return found != s.meshes.end() && found->second.is_visible;
}

std::size_t Session::add_mesh(AddedMesh mesh) {
  State& s = *state_;
  s.require_edits();
  check_mesh(s.scene(), mesh.mesh);
  if (!is_affine(mesh.world_from_object) || !has_shape(mesh.world_from_object))
    throw Error(mesh.name.empty() ? "mesh" : mesh.name, "has a matrix that flattens it, or is not affine or finite",
                "give one that can be inverted");
  const std::size_t node = s.file_nodes + s.added_nodes.size();
  s.added_nodes.push_back(mesh.name);
  s.scene().node_names.push_back(mesh.name);
  mesh.mesh.content = new_content();
  s.meshes.emplace(node, std::move(mesh));
  s.poses = s.moves = s.is_edited = true;
  return node;
}

void Session::remove_mesh(std::size_t node) {
  State& s = *state_;
  s.require_edits();
  if (s.meshes.erase(node) == 0)
    throw Error(fmt::format("node {}", node), "was not added", "name one that add_mesh() gave; hide those of the file");
  s.poses = s.moves = true;
}

Progressive& Session::begin(const RenderPlan& settings, std::function<void()> lets_go) {
  State& s = *state_;
  s.stepped.reset();
  set_settings(settings);
  s.request.render.settings.kernels.mips = true; // for frames in motion
  update();
  s.lets_go = std::move(lets_go);
  s.stepped = std::make_unique<Progressive>(*s.prepared.device, s.prepared.packed, s.prepared.view,
                                            s.request.render.settings, *s.prepared.kernels, s.on_device);
  s.is_handed = true;
  s.other_settings = s.other_view = false;
  return *s.stepped;
}

void Session::set_settings(const RenderPlan& settings) {
  State& s = *state_;
  check_camera(s.request.scene.view, settings);
  if (settings.integrator->check) settings.integrator->check(settings);
  s.request.render.settings = settings;
  s.request.render.settings.kernels.mips |= s.stepped != nullptr;
  s.other_settings = true;
}

void Session::pose() { state_->pose(state_->request.render.settings); }

SessionUpdate Session::update() { return state_->bring(state_->request.render); }

SessionUpdate Session::update(const RenderRequest& request) { return state_->bring(request); }

SessionPicture Session::render(const RenderRequest& request, const SessionHooks& hooks) {
  State& s = *state_;
  Prepared& prepared = s.prepared;
  update(request);
  plan_render(request, prepared);
  Rendered rendered = wavepath::run(request, prepared, hooks);
  RenderResult& result = rendered.result;
  SessionPicture picture;
  picture.settings = prepared.plan.settings;
  picture.view = prepared.view;
  const RenderPlan& settings = picture.settings;
  const MultiDeviceResult* shared = rendered.shared ? &*rendered.shared : nullptr;
  denoise_if_asked(result, settings);
  const bool goes_on = result.stop != StopReason::interrupted;
  const auto asks = [&] { return goes_on && (!hooks.goes_on || hooks.goes_on()); };
  const Clock::time_point passes_start = Clock::now();
  add_passes_if_asked(prepared, result, shared, asks);
  const double pass_seconds = seconds_since(passes_start);
  MissingLight missing;
  if (hooks.measures_missing_light) missing = measure_missing_light(prepared, result, shared, asks);
  picture.bias = list_bias(settings, prepared.packed, result, missing);
  picture.plan = prepared.plan.decisions;
  add_outcomes(picture.plan, result);
  if (!s.is_edited) picture.repeat = repeat_command(s.request.scene, request, s.request.motion, prepared, result);
  Run run{s.request.scene.path, hooks.command, prepared.device->info(), settings, prepared.packed, result};
  run.plan = picture.plan;
  run.repeat = picture.repeat;
  run.view = &prepared.view;
  run.load_seconds = prepared.load_seconds;
  if (std::ranges::any_of(settings.aovs, is_pass)) run.pass_seconds = pass_seconds;
  run.shared = shared;
  run.bias = picture.bias;
  run.true_errors = rendered.true_errors;
  run.diagnosis = diagnose(settings, prepared.packed, result, run.true_errors, run.bias);
  run.peak_bytes = prepared.device->memory_peak();
  run.total_seconds = seconds_since_process_start();
  run.kernel_cache = prepared.device->pipeline_cache().describe();
  picture.stats = to_text(stats_document(run));
  picture.warnings = prepared.warnings;
  if (result.nonfinite.first)
    picture.warnings.add("non-finite sample left out, " + describe_first(result.nonfinite, settings),
                         result.nonfinite.samples());
  if (result.spp == 0)
    picture.warnings.add("stopped within the first sample; pixels that it had not reached are black");
  if (result.shadows && !result.shadows->smaller.empty()) picture.warnings.add(result.shadows->smaller);
  picture.result = std::move(result);
  return picture;
}

} // namespace wavepath
