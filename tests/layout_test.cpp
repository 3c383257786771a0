// The structs that host and kernels share lie in memory as C++ has them: member by member, against what SPIR-V says.
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <span>
#include <string>

#include <gtest/gtest.h>

#include "host/base/overloaded.h"
#include "host/scene/material.h"
#include "kernels/base/frame_types.h"
#include "kernels/base/light_tree_types.h"
#include "kernels/base/scene_types.h"
#include "kernels/bidirectional/bidirectional_types.h"
#include "kernels/bidirectional/photon_types.h"
#include "kernels/film/cover_types.h"
#include "kernels/film/film_types.h"
#include "kernels/hybrid/filter_types.h"
#include "kernels/hybrid/hybrid_types.h"
#include "kernels/hybrid/reflections/reflection_types.h"
#include "kernels/hybrid/shading/shading_types.h"
#include "kernels/hybrid/shadows/planar_types.h"
#include "kernels/hybrid/shadows/shadow_types.h"
#include "kernels/path/path_types.h"
#include "kernels/radiosity/radiosity_types.h"
#include "kernels/volume/voxel_types.h"
#include "kernels/whitted/whitted_types.h"
#include "tests/probes/layout_probe.spv.h"

namespace wavepath::gpu {
namespace {

using Offsets =
    std::map<std::string, std::size_t>; // member -> byte; "sizeof" -> bytes from one array element to the next

// Reads the debug names and decorations of a SPIR-V module (SPIR-V specification 1.6, sections 3.42.2 and 3.42.3).
std::map<std::string, Offsets> spirv_layouts(std::span<const std::uint32_t> words) {
  constexpr std::uint32_t kOpName = 5, kOpMemberName = 6, kOpTypeRuntimeArray = 29, kOpDecorate = 71,
                          kOpMemberDecorate = 72;
  constexpr std::uint32_t kDecorationArrayStride = 6, kDecorationOffset = 35;
  const auto text = [](const std::uint32_t* at) { return std::string(reinterpret_cast<const char*>(at)); };
  std::map<std::uint32_t, std::string> names;
  std::map<std::uint32_t, std::map<std::uint32_t, std::string>> member_names;
  std::map<std::uint32_t, std::size_t> strides;
  std::map<std::uint32_t, Offsets> offsets;
  for (std::size_t i = 5; i < words.size(); i += words[i] >> 16) { // five words of header
    const std::uint32_t* at = &words[i];
    switch (at[0] & 0xffffu) {
      case kOpName:
        names[at[1]] = text(at + 2);
        break;
      case kOpMemberName:
        member_names[at[1]][at[2]] = text(at + 3);
        break;
      case kOpDecorate:
        if (at[2] == kDecorationArrayStride) strides[at[1]] = at[3];
        break;
      case kOpMemberDecorate:
        if (at[3] == kDecorationOffset) offsets[at[1]][member_names[at[1]][at[2]]] = at[4];
        break;
      case kOpTypeRuntimeArray:
        offsets[at[2]]["sizeof"] = strides[at[1]];
        break;
      default:
        break;
    }
  }
  std::map<std::string, Offsets> layouts;
  for (const auto& [id, members] : offsets) layouts[names[id]].insert(members.begin(), members.end());
  return layouts;
}

const std::map<std::string, Offsets>& layouts() {
  static const std::map<std::string, Offsets> result = spirv_layouts(wavepath_layout_probe_spv);
  return result;
}

bool is_padding(const std::string& member) { return member.starts_with("pad"); }

// `host`: offsetof every member but padding.
void compare(const std::string& name, std::size_t size, const Offsets& host) {
  ASSERT_TRUE(layouts().contains(name)) << name << " is not in layout_probe.comp";
  for (const auto& [member, offset] : layouts().at(name)) {
    if (member == "sizeof") {
      EXPECT_EQ(size, offset) << name;
    } else if (!is_padding(member)) {
      ASSERT_TRUE(host.contains(member)) << name << "::" << member << " is not compared";
      EXPECT_EQ(host.at(member), offset) << name << "::" << member;
    }
  }
}

#define AT(Type, member) \
  { #member, offsetof(Type, member) }

TEST(Layout, Geometry) {
  compare("Triangle", sizeof(Triangle),
          {AT(Triangle, v0), AT(Triangle, surface), AT(Triangle, v1), AT(Triangle, id), AT(Triangle, v2),
           AT(Triangle, light)});
  compare("Instance", sizeof(Instance),
          {AT(Instance, object_from_world), AT(Instance, world_from_object), AT(Instance, root), AT(Instance, flipped),
           AT(Instance, id), AT(Instance, first_light)});
}

TEST(Layout, Materials) {
  Offsets offsets = {AT(Material, flags)};
  Offsets layer_offsets = {AT(MaterialLayers, ggx_table), AT(MaterialLayers, sheen_table),
                           AT(MaterialLayers, glass_table), AT(MaterialLayers, layer_tangents)};
  const Material material{};
  const MaterialLayers layers{};
  const auto distance = [](const auto* from, const auto* to) {
    return static_cast<std::size_t>(reinterpret_cast<const char*>(to) - reinterpret_cast<const char*>(from));
  };
  const auto add = [&](const auto& row) {
    if (row.packed.material)
      offsets[row.name] = distance(&material, &(material.*row.packed.material));
    else
      layer_offsets[row.name] = distance(&layers, &(layers.*row.packed.layers));
  };
  visit_material_fields(Overloaded{add, []<class T>(const MaterialChoice<T>&) {}}); // choices are bits of `flags`
  compare("Material", sizeof(Material), offsets);
  compare("MaterialLayers", sizeof(MaterialLayers), layer_offsets);
  compare("Texture", sizeof(Texture),
          {AT(Texture, first_texel), AT(Texture, width), AT(Texture, height), AT(Texture, flags),
           AT(Texture, uv_matrix), AT(Texture, uv_offset), AT(Texture, mip_count), AT(Texture, first_mip)});
}

TEST(Layout, Lights) {
  compare("Light", sizeof(Light),
          {AT(Light, position), AT(Light, kind), AT(Light, direction), AT(Light, probability), AT(Light, intensity),
           AT(Light, end), AT(Light, pdf_area), AT(Light, triangle), AT(Light, instance), AT(Light, triangle_id),
           AT(Light, spot_scale), AT(Light, spot_offset), AT(Light, parts), AT(Light, inverse_range)});
}

TEST(Layout, LightTree) {
  compare("LightCluster", sizeof(LightCluster),
          {AT(LightCluster, lo), AT(LightCluster, link), AT(LightCluster, hi), AT(LightCluster, depth)});
  compare("LightTreeChild", sizeof(LightTreeChild),
          {AT(LightTreeChild, box0), AT(LightTreeChild, box1), AT(LightTreeChild, emission), AT(LightTreeChild, link)});
  compare("LightTreeNode", sizeof(LightTreeNode), {AT(LightTreeNode, child)});
}

TEST(Layout, Frame) {
  compare("Frame", sizeof(Frame),
          {AT(Frame, camera_position),
           AT(Frame, width),
           AT(Frame, camera_right),
           AT(Frame, height),
           AT(Frame, camera_up),
           AT(Frame, max_depth),
           AT(Frame, camera_forward),
           AT(Frame, seed),
           AT(Frame, environment_radiance),
           AT(Frame, environment_probability),
           AT(Frame, environment_rotation),
           AT(Frame, environment_width),
           AT(Frame, environment_height),
           AT(Frame, light_count),
           AT(Frame, root),
           AT(Frame, root_is_top),
           AT(Frame, orthographic),
           AT(Frame, sample_total),
           AT(Frame, slot_count),
           AT(Frame, scene_features),
           AT(Frame, local_light_count),
           AT(Frame, light_sum_scale),
           AT(Frame, probes),
           AT(Frame, scene_lobes),
           AT(Frame, first_layers),
           AT(Frame, lens_radius),
           AT(Frame, focus_distance),
           AT(Frame, motion_texel),
           AT(Frame, end_normals),
           AT(Frame, bodies_at_eye),
           AT(Frame, pixel_spread),
           AT(Frame, sky_samples),
           AT(Frame, reuses_paths),
           AT(Frame, quad_scale),
           AT(Frame, top_level),
           AT(Frame, camera_model),
           AT(Frame, eyes),
           AT(Frame, camera_shift),
           AT(Frame, clip_near),
           AT(Frame, clip_far),
           AT(Frame, eye_offset),
           AT(Frame, angle_limit),
           AT(Frame, cover),
           AT(Frame, first_catcher),
           AT(Frame, end_catcher),
           AT(Frame, film_left),
           AT(Frame, film_top),
           AT(Frame, film_width),
           AT(Frame, film_height),
           AT(Frame, pad_film),
           AT(Frame, boost_axis),
           AT(Frame, boost_scale)});
  compare("Wave", sizeof(Wave),
          {AT(Wave, first_pixel), AT(Wave, pixel_count), AT(Wave, first_sample), AT(Wave, sample_count),
           AT(Wave, bounce), AT(Wave, first_film_pixel), AT(Wave, level_entries)});
}

TEST(Layout, PathsAndQueues) {
  compare("PathState", sizeof(PathState),
          {AT(PathState, throughput), AT(PathState, bsdf_pdf), AT(PathState, radiance), AT(PathState, eta_scale)});
  compare("Ray", sizeof(Ray), {AT(Ray, origin), AT(Ray, slot), AT(Ray, direction), AT(Ray, t_max)});
  compare("Hit", sizeof(Hit), {AT(Hit, triangle), AT(Hit, instance), AT(Hit, b1), AT(Hit, b2)});
  compare("ShadowRay", sizeof(ShadowRay),
          {AT(ShadowRay, origin), AT(ShadowRay, slot), AT(ShadowRay, direction), AT(ShadowRay, t_max),
           AT(ShadowRay, contribution), AT(ShadowRay, light)});
  compare("GuideRecord", sizeof(GuideRecord),
          {AT(GuideRecord, position), AT(GuideRecord, pdf), AT(GuideRecord, direction), AT(GuideRecord, bsdf_pdf),
           AT(GuideRecord, throughput), AT(GuideRecord, before), AT(GuideRecord, after),
           AT(GuideRecord, guidable_fraction)});
  compare("GuideNode", sizeof(GuideNode), {AT(GuideNode, splits), AT(GuideNode, links)});
  compare("Queues", sizeof(Queues),
          {AT(Queues, ray_count), AT(Queues, hit_count), AT(Queues, extend_groups), AT(Queues, escape_count),
           AT(Queues, connect_groups), AT(Queues, first_shadow), AT(Queues, shade_groups), AT(Queues, next_ray),
           AT(Queues, escape_groups), AT(Queues, next_shadow_ray), AT(Queues, shadow_count), AT(Queues, sender_count)});
  compare("Counters", sizeof(Counters),
          {AT(Counters, camera_rays), AT(Counters, bounce_rays), AT(Counters, shadow_rays),
           AT(Counters, occlusion_rays), AT(Counters, nonfinite_count), AT(Counters, nonfinite_first)});
}

TEST(Layout, Film) {
  compare("ExactSum", sizeof(ExactSum), {AT(ExactSum, high), AT(ExactSum, low)});
  compare("FilmPixel", sizeof(FilmPixel),
          {AT(FilmPixel, red), AT(FilmPixel, green), AT(FilmPixel, blue), AT(FilmPixel, count), AT(FilmPixel, tops),
           AT(FilmPixel, largest), AT(FilmPixel, clamped)});
  compare("PathAovs", sizeof(PathAovs),
          {AT(PathAovs, albedo), AT(PathAovs, depth), AT(PathAovs, normal), AT(PathAovs, hit), AT(PathAovs, position),
           AT(PathAovs, unoccluded), AT(PathAovs, emission), AT(PathAovs, roughness), AT(PathAovs, direct),
           AT(PathAovs, metallic), AT(PathAovs, triangle), AT(PathAovs, instance), AT(PathAovs, material)});
  compare("FilmAovs", sizeof(FilmAovs),
          {AT(FilmAovs, albedo), AT(FilmAovs, depth), AT(FilmAovs, normal), AT(FilmAovs, hits), AT(FilmAovs, position),
           AT(FilmAovs, count), AT(FilmAovs, emission), AT(FilmAovs, unoccluded), AT(FilmAovs, direct),
           AT(FilmAovs, roughness), AT(FilmAovs, metallic), AT(FilmAovs, triangle), AT(FilmAovs, instance),
           AT(FilmAovs, material)});
}

TEST(Layout, Hybrid) {
  compare("HybridFrame", sizeof(HybridFrame),
          {AT(HybridFrame, jitter), AT(HybridFrame, near), AT(HybridFrame, far), AT(HybridFrame, ambient),
           AT(HybridFrame, ao_radius), AT(HybridFrame, sample_index), AT(HybridFrame, shadow_samples),
           AT(HybridFrame, ao_samples), AT(HybridFrame, flags), AT(HybridFrame, ao_bias), AT(HybridFrame, ao_thinness),
           AT(HybridFrame, sample_position), AT(HybridFrame, first_position), AT(HybridFrame, film_width),
           AT(HybridFrame, film_height)});
  compare("GbufferPixel", sizeof(GbufferPixel),
          {AT(GbufferPixel, normal), AT(GbufferPixel, depth), AT(GbufferPixel, albedo), AT(GbufferPixel, surface)});
}

TEST(Layout, Reflections) {
  compare("ReflectionFrame", sizeof(ReflectionFrame),
          {AT(ReflectionFrame, centre), AT(ReflectionFrame, threshold), AT(ReflectionFrame, box_low),
           AT(ReflectionFrame, map_kind), AT(ReflectionFrame, box_high), AT(ReflectionFrame, map_side),
           AT(ReflectionFrame, axis), AT(ReflectionFrame, reach), AT(ReflectionFrame, thickness),
           AT(ReflectionFrame, tolerance), AT(ReflectionFrame, pad0), AT(ReflectionFrame, pad1),
           AT(ReflectionFrame, mirrors)});
  compare("NestedRay", sizeof(NestedRay),
          {AT(NestedRay, origin), AT(NestedRay, slot), AT(NestedRay, direction), AT(NestedRay, pad0),
           AT(NestedRay, weight), AT(NestedRay, pad1)});
}

TEST(Layout, Shading) {
  compare("ShadingFrame", sizeof(ShadingFrame),
          {AT(ShadingFrame, attenuation), AT(ShadingFrame, shininess), AT(ShadingFrame, cue),
           AT(ShadingFrame, interpolation), AT(ShadingFrame, flags)});
}

TEST(Layout, Shadows) {
  compare("ShadowView", sizeof(ShadowView),
          {AT(ShadowView, x), AT(ShadowView, y), AT(ShadowView, z), AT(ShadowView, w), AT(ShadowView, depth),
           AT(ShadowView, light), AT(ShadowView, kind), AT(ShadowView, texel), AT(ShadowView, near),
           AT(ShadowView, far), AT(ShadowView, radius), AT(ShadowView, first_texel), AT(ShadowView, is_part),
           AT(ShadowView, pad0), AT(ShadowView, pad1)});
  compare("ShadowFrame", sizeof(ShadowFrame),
          {AT(ShadowFrame, size), AT(ShadowFrame, bias_kind), AT(ShadowFrame, bias), AT(ShadowFrame, ambient),
           AT(ShadowFrame, taps), AT(ShadowFrame, pattern), AT(ShadowFrame, blur), AT(ShadowFrame, exponent),
           AT(ShadowFrame, bits), AT(ShadowFrame, view_count), AT(ShadowFrame, cascades), AT(ShadowFrame, pad0)});
  compare("ShadowCounts", sizeof(ShadowCounts), {AT(ShadowCounts, answered), AT(ShadowCounts, left)});
  compare("PlanarPair", sizeof(PlanarPair),
          {AT(PlanarPair, normal), AT(PlanarPair, offset), AT(PlanarPair, light), AT(PlanarPair, is_point),
           AT(PlanarPair, height), AT(PlanarPair, tolerance), AT(PlanarPair, source), AT(PlanarPair, pad0)});
}

TEST(Layout, Bidirectional) {
  compare("BidirectionalFrame", sizeof(BidirectionalFrame),
          {AT(BidirectionalFrame, scene_centre), AT(BidirectionalFrame, scene_radius),
           AT(BidirectionalFrame, pixel_area), AT(BidirectionalFrame, light_paths), AT(BidirectionalFrame, techniques),
           AT(BidirectionalFrame, lamps_in_bodies)});
  compare("PathWeights", sizeof(PathWeights), {AT(PathWeights, connect), AT(PathWeights, others)});
  compare("LightVertex", sizeof(LightVertex),
          {AT(LightVertex, direction), AT(LightVertex, bounce), AT(LightVertex, light), AT(LightVertex, connect),
           AT(LightVertex, triangle), AT(LightVertex, instance), AT(LightVertex, b1), AT(LightVertex, b2),
           AT(LightVertex, others), AT(LightVertex, outside), AT(LightVertex, group)});
  compare("Connection", sizeof(Connection),
          {AT(Connection, origin), AT(Connection, slot), AT(Connection, direction), AT(Connection, triangle),
           AT(Connection, contribution), AT(Connection, instance), AT(Connection, pixel), AT(Connection, group),
           AT(Connection, in_body)});
  compare("ConnectionQueue", sizeof(ConnectionQueue), {AT(ConnectionQueue, count), AT(ConnectionQueue, groups)});
  compare("PhotonFrame", sizeof(PhotonFrame),
          {AT(PhotonFrame, path_count), AT(PhotonFrame, cell_count), AT(PhotonFrame, radius), AT(PhotonFrame, density),
           AT(PhotonFrame, cells_per_metre)});
  compare("Photon", sizeof(Photon),
          {AT(Photon, position), AT(Photon, normal), AT(Photon, direction), AT(Photon, link), AT(Photon, light),
           AT(Photon, others)});
  compare("PhotonCell", sizeof(PhotonCell), {AT(PhotonCell, count), AT(PhotonCell, first)});
  compare("PathCover", sizeof(PathCover),
          {AT(PathCover, environment), AT(PathCover, escaped), AT(PathCover, unblocked), AT(PathCover, arrived),
           AT(PathCover, caught_unblocked), AT(PathCover, caught_arrived), AT(PathCover, light_scale),
           AT(PathCover, state), AT(PathCover, pad0), AT(PathCover, pad1), AT(PathCover, pad2)});
  compare("FilmCover", sizeof(FilmCover),
          {AT(FilmCover, environment), AT(FilmCover, escaped), AT(FilmCover, unblocked), AT(FilmCover, arrived),
           AT(FilmCover, caught_unblocked), AT(FilmCover, caught_arrived), AT(FilmCover, tops), AT(FilmCover, count),
           AT(FilmCover, caught)});
  compare("SplatPixel", sizeof(SplatPixel),
          {AT(SplatPixel, red), AT(SplatPixel, green), AT(SplatPixel, blue), AT(SplatPixel, largest)});
}

TEST(Layout, Whitted) {
  compare("WhittedFrame", sizeof(WhittedFrame),
          {AT(WhittedFrame, ambient), AT(WhittedFrame, cutoff), AT(WhittedFrame, width), AT(WhittedFrame, triangles),
           AT(WhittedFrame, triangle_rays), AT(WhittedFrame, shadow_rays)});
  compare("WhittedNode", sizeof(WhittedNode),
          {AT(WhittedNode, origin), AT(WhittedNode, width), AT(WhittedNode, direction), AT(WhittedNode, medium),
           AT(WhittedNode, weight), AT(WhittedNode, path), AT(WhittedNode, hit), AT(WhittedNode, hit_weight),
           AT(WhittedNode, hit_medium), AT(WhittedNode, arrival), AT(WhittedNode, hit_path), AT(WhittedNode, depth),
           AT(WhittedNode, hit_depth)});
}

TEST(Layout, Radiosity) {
  compare("Patch", sizeof(Patch), {AT(Patch, triangle), AT(Patch, instance), AT(Patch, corner)});
  compare("PatchSurface", sizeof(PatchSurface),
          {AT(PatchSurface, reflectance), AT(PatchSurface, opacity), AT(PatchSurface, emission),
           AT(PatchSurface, both_sides)});
  compare("ShotBlock", sizeof(ShotBlock),
          {AT(ShotBlock, face), AT(ShotBlock, first), AT(ShotBlock, rays), AT(ShotBlock, shot)});
  compare("LinkBlock", sizeof(LinkBlock),
          {AT(LinkBlock, a), AT(LinkBlock, b), AT(LinkBlock, number), AT(LinkBlock, unused)});
  compare("SeenPoint", sizeof(SeenPoint), {AT(SeenPoint, hit), AT(SeenPoint, weight), AT(SeenPoint, back)});
}

TEST(Layout, Filters) {
  compare("CameraView", sizeof(CameraView),
          {AT(CameraView, position), AT(CameraView, orthographic), AT(CameraView, right), AT(CameraView, jitter_x),
           AT(CameraView, up), AT(CameraView, jitter_y), AT(CameraView, forward)});
  compare("Reprojection", sizeof(Reprojection),
          {AT(Reprojection, now), AT(Reprojection, before), AT(Reprojection, width), AT(Reprojection, height),
           AT(Reprojection, remembers), AT(Reprojection, still)});
  compare("DefocusLens", sizeof(DefocusLens),
          {AT(DefocusLens, focus), AT(DefocusLens, blur), AT(DefocusLens, orthographic)});
  compare("FilterBand", sizeof(FilterBand), {AT(FilterBand, first_tile), AT(FilterBand, step)});
}

TEST(Layout, Volumes) {
  compare("VoxelBox", sizeof(VoxelBox), {AT(VoxelBox, first), AT(VoxelBox, texel), AT(VoxelBox, bricks)});
  compare("VolumeFrame", sizeof(VolumeFrame),
          {AT(VolumeFrame, cells_from_world), AT(VolumeFrame, temperature_from_cells), AT(VolumeFrame, first_voxel),
           AT(VolumeFrame, cell_side), AT(VolumeFrame, density), AT(VolumeFrame, temperature), AT(VolumeFrame, cells),
           AT(VolumeFrame, first_cell), AT(VolumeFrame, scattering), AT(VolumeFrame, extinction),
           AT(VolumeFrame, absorption), AT(VolumeFrame, anisotropy), AT(VolumeFrame, emission),
           AT(VolumeFrame, kelvin_scale), AT(VolumeFrame, kelvin_offset), AT(VolumeFrame, first_kelvin)});
}

TEST(Layout, EveryStructIsInTheProbe) {
  const std::regex declaration("\nstruct (\\w+)");
  std::set<std::string> declared;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(WAVEPATH_SOURCE_DIR "/kernels")) {
    if (!entry.path().filename().string().ends_with("_types.h") || entry.path().filename() == "display_types.h")
      continue;
    std::ifstream file(entry.path());
    const std::string text{std::istreambuf_iterator<char>(file), {}};
    for (auto match = std::sregex_iterator(text.begin(), text.end(), declaration); match != std::sregex_iterator();
         ++match)
      declared.insert((*match)[1]);
  }
  EXPECT_GE(declared.size(), 15u);
  for (const std::string& name : declared) EXPECT_TRUE(layouts().contains(name)) << name;
}

} // namespace
} // namespace wavepath::gpu
