#include "host/view/divider.h"

#include <algorithm>
#include <cmath>

#include <imgui.h>

namespace wavepath {
namespace {

constexpr double kGrip = 6.0; // pixels beside the line that still hold it

} // namespace

void Divider::take(Input& input, bool held, std::uint32_t width, double& at) {
  const bool drags = input.drag_left != glm::dvec2(0.0);
  if (drags && !in_drag_) grabbed_ = std::abs(input.pointer.x - input.drag_left.x - at * width) <= kGrip;
  if (drags && grabbed_) {
    at = std::clamp(input.pointer.x / std::max(1u, width), 0.0, 1.0);
    input.drag_left = glm::dvec2(0.0);
  }
  in_drag_ = held && (in_drag_ || drags);
}

void draw_divider(double at, const std::string& left, const std::string& right) {
  const ImVec2 screen = ImGui::GetIO().DisplaySize;
  const float x = static_cast<float>(at) * screen.x, gap = 0.5f * ImGui::GetFontSize();
  const float y = screen.y - 2.0f * ImGui::GetFontSize();
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddLine(ImVec2(x, 0.0f), ImVec2(x, screen.y), IM_COL32(255, 255, 255, 160));
  const auto name = [&](float from, const std::string& text) {
    list.AddText(ImVec2(from + 1.0f, y + 1.0f), IM_COL32_BLACK, text.c_str());
    list.AddText(ImVec2(from, y), IM_COL32_WHITE, text.c_str());
  };
  name(x - gap - ImGui::CalcTextSize(left.c_str()).x, left);
  name(x + gap, right);
}

} // namespace wavepath
