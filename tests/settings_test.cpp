// The table of settings against RenderSettings: no member is forgotten, and every row that decides the picture reaches
// the identity and the copied command, which reads back to the same settings.
#include "host/integrators/hybrid/bounce/catalogue.h"
#include "host/integrators/hybrid/occlusion/catalogue.h"
#include "host/integrators/hybrid/reflections/catalogue.h"
#include "host/integrators/hybrid/shading/catalogue.h"
#include "host/integrators/hybrid/shadows/catalogue.h"
#include "host/integrators/hybrid/transparency/catalogue.h"
#include "host/render/settings/settings_table.h"

#include <cmath>
#include <map>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include "host/base/error.h"
#include "host/cli/render_flags.h"
#include "host/cli/scene_flags.h"
#include "host/render/settings/identity.h"
#include "host/render/settings/shading_settings.h"
#include "host/render/settings/shadow_settings.h"
#include "host/session/resolve.h"
#include "host/session/viewing/render_line.h"

namespace wavepath::test {
namespace {

// Every member of RenderSettings as text. A member that is added or removed does not compile here: list it below as
// well, and in a row of the table.
std::map<std::string, std::string> members(const RenderSettings& settings) {
  const auto& [integrator, width, height, crop, first_sample, last_sample, sample_total, time_limit, target_error,
               max_depth, sampler, hemisphere, direct, filter, seed, cull, traversal, textures, terminator, lens,
               first_hit, shadow_samples, ao_samples, ao_radius, occlusion, antialias, ao_bias, ao_thinness, voxels,
               ambient, shadows, shadow_size, shadow_bias, shadow_bias_amount, shadow_taps, shadow_pattern, shadow_blur,
               shadow_cascades, shadow_exponent, shadow_bits, shadow_source, shadow_cookie, shadow_ambient, shading,
               interpolation, shininess, attenuation, depth_cue, transparency, transparency_layers,
               transparency_samples, reflections, reflection_threshold, bounce, branching, techniques, cutoff, patches,
               subdivision, form_factors, patch_rays, gather, denoise, mips, lights, light_samples, sky_samples, reuse,
               adaptive, clamp, guide, specialize, aovs, aov_through, light_groups, transparent] = settings;
  const auto text = [](const auto& value) { return fmt::format("{}", value); };
  return {
      {"integrator", std::string(name_of(integrator))},
      {"width", text(width)},
      {"height", text(height)},
      {"crop", crop ? fmt::format("{},{},{},{}", crop->left, crop->top, crop->width, crop->height) : "none"},
      {"first_sample", text(first_sample)},
      {"last_sample", text(last_sample)},
      {"sample_total", text(sample_total)},
      {"time_limit", text(time_limit)},
      {"target_error", text(target_error)},
      {"max_depth", text(max_depth)},
      {"sampler", text(sampler)},
      {"hemisphere", text(hemisphere)},
      {"direct", text(direct)},
      {"filter", text(filter)},
      {"seed", text(seed)},
      {"cull", text(cull)},
      {"traversal", text(traversal)},
      {"textures", text(textures)},
      {"terminator", text(terminator)},
      {"aperture", text(lens.aperture)},
      {"focus", lens.focus ? text(*lens.focus) : "none"},
      {"blades", text(lens.blades)},
      {"first_hit", text(first_hit)},
      {"shadow_samples", text(shadow_samples)},
      {"ao_samples", text(ao_samples)},
      {"ao_radius", ao_radius ? text(*ao_radius) : "none"},
      {"occlusion", text(occlusion)},
      {"antialias", text(antialias)},
      {"ao_bias", text(ao_bias)},
      {"ao_thinness", text(ao_thinness)},
      {"voxels", text(voxels)},
      {"ambient", ambient ? fmt::format("{},{},{}", ambient->r, ambient->g, ambient->b) : "none"},
      {"shadows", text(shadows)},
      {"shadow_size", text(shadow_size)},
      {"shadow_bias", text(shadow_bias)},
      {"shadow_bias_amount", shadow_bias_amount ? text(*shadow_bias_amount) : "none"},
      {"shadow_taps", text(shadow_taps)},
      {"shadow_pattern", text(shadow_pattern)},
      {"shadow_blur", text(shadow_blur)},
      {"shadow_cascades", text(shadow_cascades)},
      {"shadow_exponent", shadow_exponent ? text(*shadow_exponent) : "none"},
      {"shadow_bits", text(shadow_bits)},
      {"shadow_source", text(shadow_source)},
      {"shadow_cookie", shadow_cookie},
      {"shadow_ambient", text(shadow_ambient)},
      {"shading", text(shading)},
      {"interpolation", text(interpolation)},
      {"shininess", shininess ? text(*shininess) : "none"},
      {"attenuation", attenuation ? text(attenuation->z) : "none"},
      {"depth_cue", depth_cue ? text(depth_cue->y) : "none"},
      {"transparency", text(transparency)},
      {"transparency_layers", text(transparency_layers)},
      {"transparency_samples", text(transparency_samples)},
      {"reflections", text(reflections)},
      {"reflection_threshold", text(reflection_threshold)},
      {"bounce", text(bounce)},
      {"branching", text(branching)},
      {"techniques", text(techniques)},
      {"cutoff", text(cutoff)},
      {"patches", text(patches)},
      {"subdivision", text(subdivision)},
      {"form-factors", text(form_factors)},
      {"patch-rays", text(patch_rays)},
      {"gather", text(gather)},
      {"denoise", text(denoise)},
      {"mips", text(mips)},
      {"lights", text(lights)},
      {"light_samples", text(light_samples)},
      {"sky_samples", text(sky_samples)},
      {"reuse", text(reuse)},
      {"adaptive", text(adaptive)},
      {"guide", text(guide)},
      {"clamp", text(clamp)},
      {"specialize", text(specialize)},
      {"aovs", fmt::format("{}", fmt::join(aovs, ","))},
      {"aov_through", text(aov_through)},
      {"light_groups", fmt::format("{}", fmt::join(light_groups, ","))},
      {"transparent", text(transparent)},
  };
}

// Rows that decide nothing that is kept. A row that is not here must reach the identity.
const std::set<std::string_view> kDecideNothing = {"traversal", "specialize", "time", "target-error"};

// An allowed value that differs from the one in `settings`.
std::string other_value(const Setting& row, const RenderSettings& settings) {
  const std::string now = text_of(row, settings);
  const auto differing = [&](std::initializer_list<std::string> values) {
    for (const std::string& value : values)
      if (value != now) return value;
    return std::string();
  };
  if (const std::vector<std::string_view> names = choices_of(row); !names.empty())
    return std::string(names[0] == now ? names[1] : names[0]);
  if (std::holds_alternative<SwitchValue>(row.value) || std::holds_alternative<OnOffValue>(row.value))
    return differing({"on", "off"});
  if (const auto* whole = std::get_if<WholeValue>(&row.value))
    return whole->highest < 128 ? differing({"3", "5"}) : differing({"128", "129"});
  if (std::holds_alternative<RadianceValue>(row.value)) return differing({"0.1,0.2,0.3", "1,2,3"});
  if (row.name == "size") return differing({"33x17", "640x480"});
  if (row.name == "crop") return differing({"1,2,30,40", "5,6,7,8"});
  if (row.name == "samples") return differing({"3:5", "4:6"});
  if (row.name == "aov") return differing({"albedo,depth", "normal"});
  if (row.name == "light-groups") return differing({"each", "Key,Fill"});
  if (row.name == "blades") return differing({"5", "6"});
  if (row.name == "shadow-bias") return differing({"normal:2", "plane:3"});
  if (row.name == "shadow-bits") return differing({"16", "32"});
  if (row.name == "shadow-exponent") return differing({"20", "30"});
  if (row.name == "attenuation") return differing({"1,0,2", "0,1,0"});
  if (row.name == "depth-cue") return differing({"1,2", "3,4"});
  if (row.name == "techniques") return differing({"hit", "light,splat"});
  return differing({"0.1", "0.2"}); // numbers
}

RenderSettings changed(const Setting& row, const RenderSettings& before) {
  RenderSettings settings = before;
  read_setting(row, other_value(row, before), settings);
  return settings;
}

// Settings in which a row counts: an integrator that takes it, and the sampler for which the number of samples counts.
RenderSettings base_for(const Setting& row) {
  RenderSettings settings;
  settings.sampler = gpu::kSamplerStratified;
  settings.sample_total = settings.last_sample;
  for (const IntegratorKind* kind : integrators())
    if (is_supported(row, *kind)) {
      settings.integrator = kind;
      break;
    }
  // A technique to which it means something.
  const auto turn_to = [&](std::uint32_t RenderSettings::*technique, std::size_t count) {
    const auto has_effect = [&] {
      return !settings.integrator->has_effect || settings.integrator->has_effect(settings, row.name);
    };
    while (!has_effect() && settings.*technique + 1 < count) ++(settings.*technique);
    if (!has_effect()) settings.*technique = 0;
  };
  if (row.name == "aov-through") settings.aovs = {"albedo"};
  turn_to(&RenderSettings::shadows, kShadowTechniques.names().size());
  turn_to(&RenderSettings::shading, kShadingModels.names().size());
  turn_to(&RenderSettings::occlusion, kOcclusionTechniques.names().size());
  turn_to(&RenderSettings::transparency, kTransparencyTechniques.names().size());
  turn_to(&RenderSettings::reflections, kReflectionTechniques.names().size());
  turn_to(&RenderSettings::bounce, kBounceTechniques.names().size());
  return settings;
}

std::string identity(const RenderSettings& settings) { return identity_of(1, View{}, settings); }

std::string line_of(const RenderSettings& settings) {
  return render_line("scene.gltf", {}, settings, {.auto_exposure = true}, "");
}

// The settings that `wavepath render` makes of a command line.
RenderSettings parsed(const std::string& line) {
  CLI::App app("", "wavepath");
  CLI::App* command = app.add_subcommand("render", "");
  SceneRequest scene;
  RenderRequest request;
  add_picture_flags(*command, kByRender, request);
  add_scene_flags(*command, scene, true);
  add_stop_flags(*command, request);
  add_transport_flags(*command, kByRender, request);
  std::istringstream words(line);
  std::vector<std::string> arguments;
  for (std::string word; words >> word;) arguments.push_back(word);
  arguments = spelled_out(arguments);
  std::ranges::reverse(arguments); // as the parser wants them
  arguments.pop_back();            // the program
  app.parse(arguments);
  resolve_samples(request);
  resolve_integrator(request);
  check_integrator(request);
  return request.settings;
}

TEST(Settings, EveryMemberIsInARowOrExempt) {
  std::set<std::string> set_by_rows;
  for (const Setting& row : settings_table()) {
    const RenderSettings before = base_for(row), after = changed(row, before);
    const auto old = members(before);
    std::size_t count = 0;
    for (const auto& [name, value] : members(after))
      if (value != old.at(name)) set_by_rows.insert(name), ++count;
    EXPECT_GE(count, 1u) << row.name << " sets nothing";
  }
  for (const auto& [name, value] : members({}))
    EXPECT_TRUE(set_by_rows.contains(name)) << name << " is in no row of settings_table.cpp";
}

TEST(Settings, WhatDecidesThePictureIsInTheIdentity) {
  for (const Setting& row : settings_table()) {
    const RenderSettings before = base_for(row), after = changed(row, before);
    EXPECT_EQ(row.decides == Decides::nothing, kDecideNothing.contains(row.name)) << row.name;
    EXPECT_EQ(row.decides == Decides::channels, row.name == "aov") << row.name;
    if (row.decides == Decides::nothing || row.name == "samples" ||
        row.name == "crop") // parts of one render share an identity
      EXPECT_EQ(identity(before), identity(after)) << row.name;
    else
      EXPECT_NE(identity(before), identity(after)) << row.name;
  }
}

TEST(Settings, WhatDecidesThePictureIsCopiedAndReadBack) {
  for (const Setting& row : settings_table()) {
    if (row.decides != Decides::picture) continue;
    const RenderSettings before = base_for(row), after = changed(row, before);
    const std::string line = line_of(after);
    EXPECT_NE(line.find(" " + flag_text(row, after)), std::string::npos) << row.name << ": " << line;
    EXPECT_NE(line, line_of(before)) << row.name;
    const RenderSettings again = parsed(line);
    EXPECT_EQ(identity(again), identity(after)) << line;
    for (const Setting& other : settings_table())
      EXPECT_EQ(text_of(other, again), text_of(other, after)) << other.name << " of " << line;
  }
}

TEST(Settings, EveryValueReadsBackAsWritten) {
  for (const Setting& row : settings_table()) {
    const RenderSettings settings = changed(row, base_for(row));
    RenderSettings again = base_for(row);
    read_setting(row, text_of(row, settings), again);
    EXPECT_EQ(members(again), members(settings)) << row.name;
  }
}

// Neighbouring numbers differ in the identity: it tells all bits.
TEST(Settings, NumbersAreExact) {
  RenderSettings one;
  one.integrator = find_integrator("hybrid");
  one.ao_radius = 0.1;
  one.ambient = glm::vec3(0.1f);
  RenderSettings other = one;
  other.ao_radius = std::nextafter(0.1, 1.0);
  EXPECT_NE(identity(one), identity(other));
  EXPECT_EQ(parsed(line_of(other)).ao_radius, other.ao_radius);
  other = one;
  other.ambient->b = std::nextafter(0.1f, 1.0f);
  EXPECT_NE(identity(one), identity(other));
  EXPECT_EQ(parsed(line_of(other)).ambient, other.ambient);
}

TEST(Settings, ARowIsNamedOnceAndListedByWhoSupportsIt) {
  const std::set<std::string_view> kOthers = {"pixel", "shutter", "velocity"}; // of the replay, the scene, the view
  const auto listed_name = [](const Setting& row) { return row.listed_as.empty() ? row.name : row.listed_as; };
  std::set<std::string_view> names, listable, listed;
  for (const Setting& row : settings_table()) {
    EXPECT_TRUE(names.insert(row.name).second) << row.name;
    listable.insert(listed_name(row));
  }
  for (const IntegratorKind* kind : integrators())
    for (const std::string_view name : kind->settings) {
      listed.insert(name);
      EXPECT_TRUE(listable.contains(name) || kOthers.contains(name)) << kind->name << " lists " << name;
    }
  for (const Setting& row : settings_table()) {
    EXPECT_EQ(row.supported_by != SupportedBy::all, listed.contains(listed_name(row))) << row.name;
    EXPECT_NE(row.offered, 0u) << row.name;
  }
}

// Values on the axis of a study are values of the flag. The panel has no widget for other kinds of values yet.
TEST(Settings, AxesAndWidgetsFit) {
  for (const Setting& row : settings_table()) {
    for (const std::string_view value : row.study) {
      RenderSettings settings = base_for(row);
      read_setting(row, std::string(value), settings);
      EXPECT_EQ(text_of(row, settings), value) << row.name;
    }
    EXPECT_TRUE(!row.label || !choices_of(row).empty() || std::holds_alternative<WholeValue>(row.value) ||
                std::holds_alternative<NumberValue>(row.value) || std::holds_alternative<SwitchValue>(row.value))
        << row.name;
  }
}

void expect_refused(const std::string& flags, const std::string& message) {
  try {
    parsed("wavepath render scene.gltf " + flags);
    ADD_FAILURE() << flags << " was taken";
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
  }
}

TEST(Settings, TheDefaultIntegratorIsAutoUnlessAFlagSpeaksAgainstIt) {
  const auto taken = [](const char* flags) {
    return name_of(parsed(std::string("wavepath render scene.gltf ") + flags).integrator);
  };
  for (const char* flags :
       {"", "--spp 4096 --max-depth 3", "--lights tree", "--samples 0:4 --spp 8", "--denoise", "--aov albedo,direct",
        "--aperture 0.1", "--time 9", "--shadow-samples 2", "--adaptive", "--adaptive off"})
    EXPECT_EQ(taken(flags), "auto") << flags;
  for (const char* flags : {"--guide", "--integrator path", "--samples 0:4"}) EXPECT_EQ(taken(flags), "path") << flags;
  EXPECT_EQ(taken("--integrator hybrid"), "hybrid");
}

TEST(Settings, WhatWouldChangeThePictureIsRefusedWhereItIsNotTaken) {
  expect_refused("--branching choice",
                 "--branching: is not supported by --integrator path; use --integrator whitted, or leave it out");
  expect_refused("--ambient 1,1,1", "--ambient: is not supported by --integrator path; use --integrator hybrid");
  expect_refused("--integrator ao --aperture 0.1",
                 "--aperture: is not supported by --integrator ao; use --integrator path, auto, bidirectional, hybrid, "
                 "whitted or radiosity");
  expect_refused("--blades 2", "is no polygon");
  expect_refused("--focus -1", "is not a number above zero");
  expect_refused("--ao-radius 2", "--ao-radius: is not supported by --integrator path");
  expect_refused("--integrator ao --ambient 1,1,1", "--ambient: is not supported by --integrator ao");
  expect_refused("--aov ao", "--aov ao: is not supported by --integrator path; use --integrator hybrid or ao");
  expect_refused("--integrator hybrid --adaptive",
                 "--adaptive: is not supported by --integrator hybrid; use --integrator path");
  for (const char* flags : {"--shadow-samples 4 --ao-samples 4", "--integrator ao --direct nee --hemisphere uniform"})
    EXPECT_NO_THROW(parsed(std::string("wavepath render scene.gltf ") + flags)) << "changes the noise alone";
}

} // namespace
} // namespace wavepath::test
