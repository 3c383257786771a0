#include "host/view/panel.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>
#include <imgui.h>
#include <imgui_stdlib.h>

#include "host/render/settings/settings_table.h"
#include "host/session/viewing/viewed_scene.h"

namespace wavepath {
namespace {

// A label to the left of its widget, in two columns.
void label(const char* text) {
  ImGui::AlignTextToFramePadding();
  ImGui::TextUnformatted(text);
  ImGui::SameLine(ImGui::GetFontSize() * 9.5f);
  ImGui::SetNextItemWidth(-1.0f);
}

void text(const std::string& line) { ImGui::TextUnformatted(line.c_str()); }

// A list of names to choose from. True if another one was chosen.
template <class Value>
bool choice(const char* name, std::span<const std::string_view> names, Value& value) {
  label(name);
  bool changed = false;
  const auto now = static_cast<std::size_t>(value);
  if (!ImGui::BeginCombo(fmt::format("##{}", name).c_str(), std::string(names[now]).c_str())) return false;
  for (std::size_t i = 0; i < names.size(); ++i)
    if (ImGui::Selectable(std::string(names[i]).c_str(), i == now) && i != now) {
      value = static_cast<Value>(i);
      changed = true;
    }
  ImGui::EndCombo();
  return changed;
}

// A whole number, taken when it is entered with Return or a step button.
bool whole(const char* name, std::uint32_t& value, std::uint32_t least, std::uint32_t most) {
  label(name);
  const std::uint32_t step = 1;
  std::uint32_t entered = value;
  ImGui::InputScalar(fmt::format("##{}", name).c_str(), ImGuiDataType_U32, &entered, &step, nullptr, "%u",
                     ImGuiInputTextFlags_EnterReturnsTrue);
  if (entered == value) return false;
  value = std::clamp(entered, least, most);
  return true;
}

bool section(const char* name, bool open = true) {
  return ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
}

std::string duration(double seconds) {
  if (!std::isfinite(seconds)) return "unknown";
  if (seconds < 60.0) return fmt::format("{:.0f} s", seconds);
  if (seconds < 3600.0) return fmt::format("{:.0f} min", seconds / 60.0);
  return fmt::format("{:.1f} h", seconds / 3600.0);
}

std::string error_text(const ProgressiveStatus& status) {
  if (status.error_spp == 0) return "not yet known";
  return fmt::format("{:.2f} % ({:.2f}..{:.2f} %)\nrelative RMS at {} spp, 95 % interval",
                     100.0 * status.error.relative_rms, 100.0 * status.error.ci95[0], 100.0 * status.error.ci95[1],
                     status.error_spp);
}

void show_statistics(const PanelState& state, const PanelFacts& facts) {
  const ProgressiveStatus& s = facts.status;
  const char* now = s.compiling ? "compiling kernels" : s.done ? "done" : s.coarse > 1 ? "moving" : "rendering";
  text(fmt::format("{}, {} of {} spp", now, s.spp, s.planned));
  if (s.coarse > 1) text(fmt::format("at 1/{} of the resolution", s.coarse));
  ImGui::ProgressBar(static_cast<float>(s.fraction), ImVec2(-1.0f, ImGui::GetFontSize() * 0.4f), "");
  text(fmt::format("{:.1f} ms a sample of all pixels", 1e3 * s.frame_seconds));
  text(fmt::format("{:.2f} Mrays/s, {:.1f} s rendered", s.mrays_per_second, s.seconds));
  text("estimated error: " + error_text(s));
  if (state.target_error > 0.0)
    text(fmt::format("to {:.2g} %: {}", 100.0 * state.target_error,
                     facts.seconds_to_target <= 0.0 ? "reached" : duration(facts.seconds_to_target)));
  text(fmt::format("{:.0f} MiB on the device", static_cast<double>(s.memory.total()) / (1u << 20)));
}

void show_view(PanelState& state) {
  DisplayOptions& display = state.display;
  choice("show", kShownNames, display.shown);
  label("exposure, stops");
  auto exposure = static_cast<float>(display.exposure);
  ImGui::SetNextItemWidth(-ImGui::GetFontSize() * 4.0f);
  if (ImGui::SliderFloat("##exposure", &exposure, -10.0f, 10.0f, "%.2f")) {
    display.exposure = exposure;
    display.auto_exposure = false;
  }
  ImGui::SameLine();
  ImGui::Checkbox("auto##exposure", &display.auto_exposure);
  choice("tone curve", kTonemapNames, display.tonemap);
}

constexpr float kMostGain = 16.0f;

void show_light_groups(PanelState& state) {
  const std::vector<std::string>& names = state.settings.group_names;
  std::vector<float>& gains = state.display.group_gains;
  gains.resize(names.size(), 1.0f);
  for (std::size_t g = 0; g < names.size(); ++g) {
    label(names[g].c_str());
    ImGui::PushID(static_cast<int>(g));
    ImGui::SliderFloat("##gain", &gains[g], 0.0f, kMostGain, "%.2f",
                       ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    ImGui::PopID();
  }
  if (state.display.mixes() && ImGui::Button("all 1")) std::ranges::fill(gains, 1.0f);
}

void show_shadows(PanelState& state, const PanelFacts& facts) {
  ComparisonChoice& comparison = state.comparison;
  label("split screen");
  ImGui::Checkbox("##split", &comparison.split);
  choice("against", choices_of(setting_named("shadows")), comparison.against);
  if (comparison.split) {
    label("divider");
    auto at = static_cast<float>(comparison.at);
    if (ImGui::SliderFloat("##divider", &at, 0.0f, 1.0f, "%.2f")) comparison.at = at;
  }
  if (const std::optional<ShadowReport>& shadows = facts.status.shadows) {
    text(fmt::format("build {:.1f} ms, look-up {:.1f} ms", shadows->build.median, shadows->look_up.median));
    text(fmt::format("{} views, {:.1f} MiB", shadows->views, static_cast<double>(shadows->bytes) / (1u << 20)));
  }
  if (!facts.score) return;
  text(fmt::format("falsely lit {:.2f} %, dark {:.2f} %", 100.0 * facts.score->falsely_lit,
                   100.0 * facts.score->falsely_dark));
  text(fmt::format("error of direct light {:.2f} %", 100.0 * facts.score->relative_rms));
}

// The widget of a setting, by the kind of its value. True if it was changed.
bool widget(const Setting& row, RenderPlan& settings) {
  if (const auto* kind = std::get_if<ChoiceValue>(&row.value); kind && !kind->bare.empty()) {
    bool on = settings.*kind->member != 0;
    label(row.label);
    if (!ImGui::Checkbox(fmt::format("##{}", row.label).c_str(), &on)) return false;
    read_setting(row, on ? std::string(kind->bare) : text_of(row, RenderPlan{}), settings);
    return true;
  }
  if (const std::vector<std::string_view> names = choices_of(row); !names.empty()) {
    auto index = std::ranges::find(names, text_of(row, settings)) - names.begin();
    if (!choice(row.label, names, index)) return false;
    read_setting(row, std::string(names[static_cast<std::size_t>(index)]), settings);
    return true;
  }
  if (const auto* number = std::get_if<WholeValue>(&row.value)) {
    std::uint32_t value = number_of(*number, settings);
    if (!whole(row.label, value, number->lowest, number->highest)) return false;
    settings.*number->member = value;
    return true;
  }
  label(row.label);
  if (const auto* number = std::get_if<NumberValue>(&row.value)) {
    double& kept = number->in(settings);
    double value = kept;
    if (!ImGui::InputDouble(fmt::format("##{}", row.label).c_str(), &value, 0.0, 0.0, "%.4g",
                            ImGuiInputTextFlags_EnterReturnsTrue))
      return false;
    kept = std::clamp(value, number->lowest, number->highest);
    return true;
  }
  return ImGui::Checkbox(fmt::format("##{}", row.label).c_str(), &(settings.*std::get<SwitchValue>(row.value).member));
}

void show_transport(PanelState& state, PanelWishes& wishes) {
  RenderPlan& settings = state.settings;
  const std::uint32_t planned = settings.sample_total;
  for (const Setting& row : settings_table())
    if (is_viewed(row, *settings.integrator)) wishes.settings |= widget(row, settings);
  settle(settings, planned);
  label("target error, %");
  auto percent = static_cast<float>(100.0 * state.target_error);
  if (ImGui::InputFloat("##target", &percent, 0.0f, 0.0f, "%.3g")) state.target_error = std::max(0.0f, percent) / 100.0;
}

void show_environment(PanelState& state, PanelWishes& wishes) {
  EnvironmentRequest& choice = state.environment;
  label("file or R,G,B");
  ImGui::InputText("##environment", &choice.source);
  wishes.environment |= ImGui::IsItemDeactivatedAfterEdit();
  label("intensity");
  auto intensity = static_cast<float>(choice.intensity);
  if (ImGui::DragFloat("##intensity", &intensity, 0.01f, 0.0f, 1e6f, "%.3g", ImGuiSliderFlags_AlwaysClamp))
    choice.intensity = intensity;
  wishes.environment |= ImGui::IsItemDeactivatedAfterEdit();
  label("rotation, deg");
  auto rotation = static_cast<float>(choice.degrees);
  if (ImGui::DragFloat("##rotation", &rotation, 1.0f, -360.0f, 360.0f, "%.1f", ImGuiSliderFlags_AlwaysClamp))
    choice.degrees = rotation;
  wishes.environment |= ImGui::IsItemDeactivatedAfterEdit();
}

void show_variants(PanelState& state, const PanelFacts& facts, PanelWishes& wishes) {
  const auto choose = [&](const std::string& name, const std::string& shown) {
    if (!ImGui::Selectable(shown.c_str(), state.variant == name) || state.variant == name) return;
    state.variant = name;
    wishes.variant = true;
  };
  choose("", "none##variant");
  for (std::size_t i = 0; i < facts.variants.size(); ++i)
    choose(facts.variants[i], fmt::format("{}##variant{}", facts.variants[i], i));
}

void show_cameras(const PanelFacts& facts, PanelWishes& wishes) {
  if (ImGui::Button("reset (R)")) wishes.reset = true;
  ImGui::SameLine();
  if (ImGui::Button("frame (Home)")) wishes.frame = true;
  ImGui::SameLine();
  if (ImGui::Button("copy (C)")) wishes.copy = true;
  for (std::size_t i = 0; i < facts.cameras.size(); ++i) {
    const std::string key = i < 9 ? fmt::format(" ({})", i + 1) : "";
    if (ImGui::Selectable(fmt::format("{} {}{}##camera{}", i, facts.cameras[i], key, i).c_str())) wishes.camera = i;
  }
  ImGui::TextDisabled(
      "left drag: orbit   middle: pan\nright drag: look   wheel: nearer\nWASD QE: fly       shift: fast\n"
      "double click, F: focus there\nH: hide this   Ctrl+Q: quit");
}

} // namespace

PanelWishes show_panel(PanelState& state, const PanelFacts& facts) {
  PanelWishes wishes;
  if (!state.visible) return wishes;
  const float unit = ImGui::GetFontSize();
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.6f * unit, 0.6f * unit), ImGuiCond_FirstUseEver);
  ImGui::SetNextWindowSizeConstraints(ImVec2(22.0f * unit, 0.0f),
                                      ImVec2(22.0f * unit, std::max(unit, screen.y - 1.2f * unit)));
  if (ImGui::Begin("wavepath", nullptr, ImGuiWindowFlags_AlwaysAutoResize)) {
    text(facts.scene);
    ImGui::TextDisabled("%s", facts.device.c_str());
    show_statistics(state, facts);
    if (section("picture")) show_view(state);
    if (!state.settings.group_names.empty() && section("light groups")) show_light_groups(state);
    if (supports(*state.settings.integrator, "shadows") && section("shadows")) show_shadows(state, facts);
    if (section("light transport")) show_transport(state, wishes);
    if (section("environment", false)) show_environment(state, wishes);
    if (!facts.variants.empty() && section("variant")) show_variants(state, facts, wishes);
    if (section("camera")) show_cameras(facts, wishes);
    if (!facts.notes.empty() && section("approximated", false))
      for (const std::string& note : facts.notes) ImGui::TextWrapped("%s", note.c_str());
    ImGui::Separator();
    if (ImGui::Button("save EXR (X)")) wishes.save_exr = true;
    ImGui::SameLine();
    if (ImGui::Button("save PNG (P)")) wishes.save_png = true;
    if (!state.message.empty()) ImGui::TextWrapped("%s", state.message.c_str());
  }
  ImGui::End();
  return wishes;
}

} // namespace wavepath
