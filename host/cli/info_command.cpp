// wavepath info: the Vulkan devices of this machine, or the contents of a scene and what a render of it needs.
#include <memory>

#include <fmt/format.h>

#include "host/base/memory.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/plan_report.h"
#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/film/group_layers.h"
#include "host/gpu/device.h"
#include "host/gpu/device_choice.h"
#include "host/plan/bvh_quality.h"
#include "host/plan/integrator.h"
#include "host/plan/memory.h"
#include "host/plan/plan.h"
#include "host/plan/record.h"
#include "host/render/report/camera_json.h"
#include "host/render/report/lamp_extents.h"
#include "host/render/report/stats.h"
#include "host/render/report/volume_json.h"
#include "host/render/settings/integrator_kind.h"
#include "host/render/settings/mips.h"
#include "host/render/settings/shadow_settings.h"
#include "host/render/workspace/workspace.h"
#include "host/scene/pack/light_groups.h"
#include "host/scene/pack/plan.h"
#include "host/session/resolve.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

struct InfoCommandRequest {
  SceneRequest scene;
  RenderRequest render;
  bool json = false, plan = false;
};

Json to_json(const DeviceInfo& device) {
  return {{"name", device.name},
          {"driver", device.driver},
          {"type", device.type},
          {"api", device.api},
          {"subgroup_size", device.subgroup_size},
          {"memory_bytes", device.memory_bytes},
          {"max_storage_range", device.max_storage_range},
          {"max_texel_elements", device.max_texel_elements},
          {"max_allocation", device.max_allocation},
          {"max_groups", device.max_groups},
          {"timestamp_period_ns", device.timestamp_period_ns},
          {"missing", device.missing}};
}

void print_device(std::size_t index, const DeviceInfo& device) {
  print_out("device {}: {}\n", index, device.name);
  print_out("  driver                    {}\n", device.driver);
  print_out("  type                      {}, Vulkan {}\n", device.type, device.api);
  print_out("  subgroup size             {}\n", device.subgroup_size);
  print_out("  memory                    {}\n", to_size_text(device.memory_bytes));
  print_out("  largest allocation        {}\n", to_size_text(device.max_allocation));
  print_out("  largest storage buffer    {}\n", to_size_text(device.max_storage_range));
  print_out("  largest texel buffer      {} texels\n", device.max_texel_elements);
  print_out("  workgroups in a dispatch  {}\n", device.max_groups);
  print_out("  timestamps                {}\n",
            device.timestamp_period_ns > 0.0 ? fmt::format("every {} ns", device.timestamp_period_ns) : "none");
  print_out("  missing for wavepath      {}\n",
            device.missing.empty() ? "nothing" : fmt::format("{}", fmt::join(device.missing, "; ")));
}

int run_devices(const InfoCommandRequest& request) {
  const std::vector<DeviceInfo> devices = list_devices();
  if (request.json) {
    Json list = Json::array();
    for (const DeviceInfo& device : devices) list.push_back(to_json(device));
    print_out("{}", to_text({{"wavepath", WAVEPATH_VERSION}, {"devices", list}}));
    return kExitDone;
  }
  print_out("wavepath {}\n", WAVEPATH_VERSION);
  for (std::size_t i = 0; i < devices.size(); ++i) print_device(i, devices[i]);
  if (devices.empty()) print_out("no Vulkan device: {}\n", driver_remedy());
  return kExitDone;
}

Json to_json(const std::vector<MemoryItem>& items) {
  Json json = Json::object();
  for (const MemoryItem& item : items) json[std::string(item.name)] = item.bytes;
  json["total"] = total_bytes(items);
  return json;
}

// What a render takes besides the scene: each of the ways that --integrator auto may take.
Json describe_renders(const RenderPlan& settings, const ScenePlan& planned, const PackedScene& packed) {
  const std::vector<RenderPlan> candidates =
      settings.integrator.is_auto() ? candidates_of(settings, packed) : std::vector{settings};
  Json renders = Json::array();
  for (const RenderPlan& candidate : candidates) {
    const MemoryPlan plan = plan_memory(candidate, planned, packed.features);
    renders.push_back({{"flags", candidate_text(candidate)},
                       {"size", {candidate.width, candidate.height}},
                       {"bytes", to_json(plan.render)},
                       {"path_bytes", to_json(plan.path)}});
  }
  return renders;
}

// What --guide takes besides, whatever the scene.
std::uint64_t guide_bytes() {
  RenderPlan guided;
  guided.guide = true;
  return total_bytes(guided.integrator->items(guided, {}, 0));
}

// Bytes of the film of a picture of the usual size, with error probes and with two replicates a pixel.
Json film_bytes() {
  RenderPlan whole, halved;
  halved.aovs = {"variance"};
  FilmShape parted = film_shape(halved);
  parted.aovs = false;
  return {{"size", {whole.width, whole.height}},
          {"whole_nets", film_shape(whole).bytes()},
          {"halved_nets", parted.bytes()}};
}

// What info tells of a scene, in the order in which it is printed.
Json describe(const std::string& path, const Scene& scene, const ScenePlan& planned, const PackedScene& packed) {
  Json cameras = Json::array(), left_out = Json::array(), warnings = Json::array();
  for (const Camera& camera : scene.cameras) cameras.push_back(camera_json(camera));
  for (const LeftOut& entry : packed.left_out)
    left_out.push_back({{"what", entry.what}, {"why", entry.why}, {"bytes", entry.bytes}});
  for (const auto& [text, count] : scene.warnings.counts()) warnings.push_back({{"text", text}, {"count", count}});
  const auto emissive = std::count_if(packed.lights.begin(), packed.lights.end(),
                                      [](const auto& l) { return l.kind == gpu::kLightTriangle; });
  return {{"wavepath", WAVEPATH_VERSION},
          {"scene", path},
          {"triangles", packed.triangle_count},
          {"triangles_stored", planned.triangles_stored},
          {"cut", {{"triangles", packed.cut.triangles}, {"pieces", packed.cut.pieces}, {"coarse", packed.cut.coarse}}},
          {"instances", scene.instances.size()},
          {"meshes", scene.meshes.size()},
          {"materials", scene.materials.size()},
          {"images", scene.images.size()},
          {"textures", packed.textures.size()},
          {"lights",
           {{"punctual", scene.lights.size()},
            {"emissive_triangles", emissive},
            {"environment", scene.environment.present()}}},
          {"volume", scene.volume ? volume_json(*scene.volume) : Json(nullptr)},
          {"cameras", cameras},
          {"extensions", scene.extensions_used},
          {"variants", scene.variants},
          {"bytes",
           {{"triangles", planned.triangle_bytes},
            {"nodes", planned.node_bytes},
            {"vertices", planned.vertex_bytes},
            {"texels", planned.texel_bytes},
            {"environment", planned.environment_bytes},
            {"lights", planned.light_bytes},
            {"light tree", planned.light_tree_bytes},
            {"total", planned.total()}}},
          {"guide_bytes", guide_bytes()},
          {"film_bytes", film_bytes()},
          {"left_out", left_out},
          {"warnings", warnings}};
}

std::string join_or_none(const std::vector<std::string>& words) {
  return words.empty() ? "none" : fmt::format("{}", fmt::join(words, ", "));
}

void print_render(const Json& render) {
  const auto number = [](const Json& json) { return json.get<std::uint64_t>(); };
  const Json &bytes = render["bytes"], &path_bytes = render["path_bytes"];
  print_out("  {}\n    at {}x{} at most {} more, and {} for each path in flight\n", render["flags"].get<std::string>(),
            number(render["size"][0]), number(render["size"][1]), to_size_text(number(bytes["total"])),
            to_size_text(number(path_bytes["total"])));
  for (const auto& [what, count] : bytes.items())
    if (what != "total") print_out("    {:<24}{}\n", what, to_size_text(number(count)));
  for (const auto& [what, count] : path_bytes.items())
    if (what != "total") print_out("    {:<24}{} a path\n", what, to_size_text(number(count)));
}

// Clip planes of the file, which a render passes by unless it is asked.
std::string planes_text(const Json& camera) {
  if (camera["znear"].is_null()) return "";
  const std::string far = camera["zfar"].is_null() ? "infinity" : fmt::format("{:g}", camera["zfar"].get<double>());
  return fmt::format(", planes at {:g} and {} m, ignored without --clip file", camera["znear"].get<double>(), far);
}

void print_view(const Json& view) {
  const auto list = [](const Json& values) {
    std::vector<std::string> words;
    for (const Json& value : values) words.push_back(fmt::format("{:.6g}", value.get<double>() + 0.0)); // no -0
    return fmt::format("{}", fmt::join(words, ", "));
  };
  print_out("      {} from {} along {}\n", view["projection"].get<std::string>(), list(view["position"]),
            list(view["forward"]));
  if (!view["fov"].is_null())
    print_out("      shows {:.6g} by {:.6g} degrees\n", view["fov"][0].get<double>(), view["fov"][1].get<double>());
  if (const Json& k = view["intrinsics"]; !k.is_null()) print_out("      --intrinsics {}\n", list(k));
}

// The cameras of the file, and the one of a render with these flags.
void print_cameras(const Json& about, const RenderPlan& settings) {
  const Json& cameras = about["cameras"];
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    print_out("    camera {} '{}' at {}x{}\n", i, cameras[i]["name"].get<std::string>(), settings.width,
              settings.height);
    if (const Json& view = cameras[i]["view"]; view.is_null())
      print_out("      not with these flags\n");
    else
      print_view(view);
    print_out("      matrix, by rows:\n");
    for (std::size_t row = 0; row < 4; ++row) {
      print_out("       ");
      for (std::size_t column = 0; column < 4; ++column)
        print_out(" {:>12.6g}", cameras[i]["world_from_camera"][4 * row + column].get<double>());
      print_out("\n");
    }
  }
  print_out("    a render at {}x{}\n", settings.width, settings.height);
  print_view(about["camera"]);
}

// Groups of --light-groups, or null.
Json describe_groups(const Scene& scene, const std::vector<std::string>& asked) {
  if (asked.empty()) return nullptr;
  const LightGroups groups = find_light_groups(scene, asked);
  const std::vector<std::string> layers = group_layers(groups.names);
  const std::vector<std::vector<std::string>> lights = lights_of(scene, groups);
  Json list = Json::array();
  for (std::size_t g = 0; g < lights.size(); ++g)
    list.push_back({{"name", groups.names[g]}, {"layer", layers[g]}, {"lights", lights[g]}});
  return list;
}

void print_groups(const Json& lights) {
  const auto words = [](const Json& list) { return in_short(list.get<std::vector<std::string>>()); };
  if (lights["groups"].is_null() && !lights["names"].empty()) print_out("  named       {}\n", words(lights["names"]));
  for (const Json& group : lights["groups"])
    print_out("  group       {}: {}\n", group["name"].get<std::string>(), words(group["lights"]));
}

std::string soft_text(const Json& soft) {
  std::vector<std::string> extents;
  if (soft.is_null()) return {};
  if (const Json& degrees = soft["sun_angle"]; !degrees.is_null())
    extents.push_back(fmt::format("directional lights {:.4g} degrees across", degrees.get<double>()));
  if (const Json& metres = soft["lamp_radius"]; !metres.is_null())
    extents.push_back(fmt::format("point and spot lights of radius {:.4g} m", metres.get<double>()));
  return fmt::format("{}", fmt::join(extents, ", "));
}

void print_volume(const Json& volume) {
  const auto triple = [](const Json& v) {
    return fmt::format("{:.6g}, {:.6g}, {:.6g}", v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
  };
  print_out("  volume      {}\n", volume["file"].get<std::string>());
  for (const Json& grid : volume["grids"])
    print_out("    grid '{}'\n      {} x {} x {} voxels in {} bricks, {} of them stored; {}; largest value {:.6g}\n",
              grid["name"].get<std::string>(), grid["box_voxels"][0].get<int>(), grid["box_voxels"][1].get<int>(),
              grid["box_voxels"][2].get<int>(), grid["bricks"].get<std::uint64_t>(),
              grid["stored_bricks"].get<std::uint64_t>(), to_size_text(grid["bytes"].get<std::uint64_t>()),
              grid["largest"].get<double>());
  print_out("    box         {} to {} m\n", triple(volume["box"][0]), triple(volume["box"][1]));
  print_out("    scatters    {} /m where the density is 1, anisotropy {:.6g}\n", triple(volume["scattering"]),
            volume["anisotropy"].get<double>());
  print_out("    absorbs     {} /m\n", triple(volume["absorption"]));
  if (volume["shines"].get<bool>())
    print_out("    shines      {:.6g} times as black bodies of {:.6g} * (temperature - {:.6g}) K\n",
              volume["emission"].get<double>(), volume["temperature_scale"].get<double>(),
              volume["temperature_offset"].get<double>());
}

void print_scene(const Json& about, const std::vector<std::string>& extensions, const RenderPlan& settings) {
  const auto number = [](const Json& json) { return json.get<std::uint64_t>(); };
  const Json &lights = about["lights"], &bytes = about["bytes"];
  print_out("{}\n", about["scene"].get<std::string>());
  print_out("  triangles   {} seen, {} stored, {} instances of {} meshes\n", number(about["triangles"]),
            number(about["triangles_stored"]), number(about["instances"]), number(about["meshes"]));
  if (const Json& cut = about["cut"]; number(cut["triangles"]) > 0)
    print_out("  cut         {} that are huge beside their distance to the eye, into {} pieces\n",
              number(cut["triangles"]), number(cut["pieces"]));
  print_out("  materials   {}\n", number(about["materials"]));
  print_out("  textures    {} uses of {} images\n", number(about["textures"]), number(about["images"]));
  print_out("  lights      {} punctual, {} emissive triangles, {}\n", number(lights["punctual"]),
            number(lights["emissive_triangles"]),
            lights["environment"].get<bool>() ? "an environment" : "no environment");
  print_groups(lights);
  if (const std::string soft = soft_text(lights["soft"]); !soft.empty()) print_out("  soft        {}\n", soft);
  if (const auto rule = lights["by_rule"].get<std::string>(); !rule.empty()) print_out("  lit         {}\n", rule);
  if (const Json& volume = about["volume"]; !volume.is_null()) print_volume(volume);
  std::vector<std::string> cameras;
  for (const Json& camera : about["cameras"])
    cameras.push_back(fmt::format("{} '{}' ({}{})", cameras.size(), camera["name"].get<std::string>(),
                                  camera["kind"].get<std::string>(), planes_text(camera)));
  print_out("  cameras     {}\n", cameras.empty() ? "none: the scene is framed automatically" : join_or_none(cameras));
  print_cameras(about, settings);
  print_out("  extensions  {}\n", join_or_none(extensions));
  if (const Json& variants = about["variants"]; !variants.empty())
    print_out("  variants    {}\n", join_or_none(variants.get<std::vector<std::string>>()));
  print_out("  planned     {} on the device\n", to_size_text(number(bytes["total"])));
  for (const auto& [what, count] : bytes.items())
    if (what != "total" && number(count) > 0) print_out("    {:<12}{}\n", what, to_size_text(number(count)));
  for (const Json& render : about["renders"]) print_render(render);
  print_out("  left out{}\n", about["left_out"].empty() ? "    nothing" : "");
  for (const Json& entry : about["left_out"])
    print_out("    {}: {}{}\n", entry["what"].get<std::string>(), entry["why"].get<std::string>(),
              number(entry["bytes"]) > 0 ? ", saves " + to_size_text(number(entry["bytes"])) : "");
}

// View of each camera of the file with the flags of projection and size; null where they do not go together.
Json describe_views(const Scene& scene, const Framing& framing, const ViewRequest& asked, const RenderPlan& settings) {
  Json views = Json::array();
  for (std::size_t i = 0; i < scene.cameras.size(); ++i) {
    ViewRequest request = asked;
    request.eye = request.look_at = request.up = std::nullopt;
    Scene alone; // so that no other one's name is its number
    alone.path = scene.path;
    alone.cameras = {scene.cameras[i]};
    request.camera.clear();
    try {
      const View view = resolve_view(alone, framing, request, settings.width, settings.height);
      views.push_back(camera_json(view, settings.width, settings.height));
    } catch (const Error&) {
      views.push_back(nullptr);
    }
  }
  return views;
}

// What a render would do, as far as it is known before its pilots.
std::vector<Decision> plan_by_rules(const InfoCommandRequest& request, const RenderPlan& settings,
                                    const ScenePlan& planned, const PackedScene& packed) {
  const std::vector<DeviceInfo> devices = list_devices();
  const DeviceInfo device = devices.empty() ? DeviceInfo{} : devices[choose_device(devices, "")];
  const PlanRequest asked{.settings = settings, .policy = Policy::rules, .stands_alone = stands_alone(request.render)};
  std::vector<Decision> decisions =
      decide(asked, packed, devices.empty() ? DeviceClass::cpu : class_of(device), nullptr).decisions;
  decisions.push_back(decision_of(choose_quality(settings, planned.triangles_stored, device)));
  return decisions;
}

std::string part_text(const RenderPlan& settings) {
  if (!settings.crop) return "";
  const Crop& crop = *settings.crop;
  return fmt::format(", of it {}x{} from {},{} on", crop.width, crop.height, crop.left, crop.top);
}

int run_scene(InfoCommandRequest& request) {
  resolve_settings(request.scene, request.render);
  check_camera(request.scene.view, request.render.settings);
  RenderPlan& settings = request.render.settings;
  LoadedScene loaded = load_scene(request.scene);
  Scene& scene = loaded.scene;
  const View view = resolve_view(scene, loaded.framing, request.scene.view, settings.width, settings.height);
  const Packing packing{
      .direct = direct_of(settings), .near = {view.position}, .lights = settings.lights, .mips = wants_mips(settings)};
  settings.group_names = find_group_names(scene, settings.light_groups);
  const ScenePlan planned = plan(scene, packing);
  require_memory(request.scene.path, "packing it", planned.total(), "use a simpler scene");
  const PackedScene packed = pack(scene, packing);
  settings.moving = packed.moves();
  Json about = describe(request.scene.path, scene, planned, packed);
  about["lights"]["by_rule"] = loaded.light;
  about["lights"]["soft"] = lamp_extents_json(packed);
  about["lights"]["names"] = light_names(scene);
  about["lights"]["groups"] = describe_groups(scene, settings.light_groups);
  const Json views = describe_views(scene, loaded.framing, request.scene.view, settings);
  for (std::size_t i = 0; i < views.size(); ++i) about["cameras"][i]["view"] = views[i];
  about["camera"] = camera_json(view, settings.width, settings.height);
  about["renders"] = describe_renders(settings, planned, packed);
  const std::vector<Decision> decisions =
      request.plan ? plan_by_rules(request, settings, planned, packed) : std::vector<Decision>();
  if (request.plan) about["plan"] = to_json(decisions);
  if (request.json) {
    print_out("{}", to_text(about));
  } else {
    print_scene(about, scene.extensions_used, settings);
    if (request.plan)
      print_out("plan of a render at {}x{}{}, {} spp\n{}", settings.width, settings.height, part_text(settings),
                settings.last_sample, plan_table(decisions));
  }
  print_warnings(scene.warnings);
  return kExitDone;
}

} // namespace

Command add_info(CLI::App& app) {
  CLI::App* command =
      add_command(app, "info", "list the Vulkan devices, or describe a scene and the memory that a render needs");
  const auto request = std::make_shared<InfoCommandRequest>();
  add_scene_flags(*command, request->scene, false);
  add_shutter_flag(*command, request->scene);
  add_view_flags(*command, request->scene.view);
  add_settings_of_render(*command, request->render);
  add_switch(
      *command, "Output",
      {"--plan", "",
       "print the plan of a render with these flags: each decision, its reason, and the size of its pilots", "off"},
      request->plan);
  add_switch(*command, "Output", {"--json", "", "print one JSON document", "off"}, request->json);
  return [request] { return request->scene.path.empty() ? run_devices(*request) : run_scene(*request); };
}

} // namespace wavepath
