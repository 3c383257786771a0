#pragma once
#include <cstdint>
#include <vector>
#include <glm/glm.hpp>
namespace wavepath { std::vector<glm::vec4> blackbody_table(float lowest, float highest, std::uint32_t count); }
