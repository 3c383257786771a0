// The table of payloads, by the numbers that Vulkan gives them.
#include "ktx/formats.h"

#include <algorithm>
#include <array>

namespace wavepath::ktx {
namespace {

constexpr std::array kFormats = std::to_array<Format>({
    {9, "R8", Coding::bytes, 1, 1, 1, 1, false, false},
    {10, "R8 signed", Coding::signed_bytes, 1, 1, 1, 1, false, false},
    {15, "R8 sRGB", Coding::bytes, 1, 1, 1, 1, false, true},
    {16, "RG8", Coding::bytes, 1, 1, 2, 2, false, false},
    {17, "RG8 signed", Coding::signed_bytes, 1, 1, 2, 2, false, false},
    {22, "RG8 sRGB", Coding::bytes, 1, 1, 2, 2, false, true},
    {23, "RGB8", Coding::bytes, 1, 1, 3, 3, false, false},
    {24, "RGB8 signed", Coding::signed_bytes, 1, 1, 3, 3, false, false},
    {29, "RGB8 sRGB", Coding::bytes, 1, 1, 3, 3, false, true},
    {30, "BGR8", Coding::bytes, 1, 1, 3, 3, true, false},
    {36, "BGR8 sRGB", Coding::bytes, 1, 1, 3, 3, true, true},
    {37, "RGBA8", Coding::bytes, 1, 1, 4, 4, false, false},
    {38, "RGBA8 signed", Coding::signed_bytes, 1, 1, 4, 4, false, false},
    {43, "RGBA8 sRGB", Coding::bytes, 1, 1, 4, 4, false, true},
    {44, "BGRA8", Coding::bytes, 1, 1, 4, 4, true, false},
    {50, "BGRA8 sRGB", Coding::bytes, 1, 1, 4, 4, true, true},
    {51, "RGBA8", Coding::bytes, 1, 1, 4, 4, false, false},
    {57, "RGBA8 sRGB", Coding::bytes, 1, 1, 4, 4, false, true},
    {70, "R16", Coding::words, 1, 1, 2, 1, false, false},
    {71, "R16 signed", Coding::signed_words, 1, 1, 2, 1, false, false},
    {76, "R16 float", Coding::halves, 1, 1, 2, 1, false, false},
    {77, "RG16", Coding::words, 1, 1, 4, 2, false, false},
    {78, "RG16 signed", Coding::signed_words, 1, 1, 4, 2, false, false},
    {83, "RG16 float", Coding::halves, 1, 1, 4, 2, false, false},
    {84, "RGB16", Coding::words, 1, 1, 6, 3, false, false},
    {85, "RGB16 signed", Coding::signed_words, 1, 1, 6, 3, false, false},
    {90, "RGB16 float", Coding::halves, 1, 1, 6, 3, false, false},
    {91, "RGBA16", Coding::words, 1, 1, 8, 4, false, false},
    {92, "RGBA16 signed", Coding::signed_words, 1, 1, 8, 4, false, false},
    {97, "RGBA16 float", Coding::halves, 1, 1, 8, 4, false, false},
    {100, "R32 float", Coding::floats, 1, 1, 4, 1, false, false},
    {103, "RG32 float", Coding::floats, 1, 1, 8, 2, false, false},
    {106, "RGB32 float", Coding::floats, 1, 1, 12, 3, false, false},
    {109, "RGBA32 float", Coding::floats, 1, 1, 16, 4, false, false},
    {122, "B10G11R11", Coding::small_floats, 1, 1, 4, 4, false, false},
    {123, "E5B9G9R9", Coding::shared_exponent, 1, 1, 4, 4, false, false},
    {131, "BC1", Coding::bc1_opaque, 4, 4, 8, 4, false, false},
    {132, "BC1 sRGB", Coding::bc1_opaque, 4, 4, 8, 4, false, true},
    {133, "BC1 alpha", Coding::bc1, 4, 4, 8, 4, false, false},
    {134, "BC1 alpha sRGB", Coding::bc1, 4, 4, 8, 4, false, true},
    {135, "BC2", Coding::bc2, 4, 4, 16, 4, false, false},
    {136, "BC2 sRGB", Coding::bc2, 4, 4, 16, 4, false, true},
    {137, "BC3", Coding::bc3, 4, 4, 16, 4, false, false},
    {138, "BC3 sRGB", Coding::bc3, 4, 4, 16, 4, false, true},
    {139, "BC4", Coding::bc4, 4, 4, 8, 4, false, false},
    {140, "BC4 signed", Coding::bc4_signed, 4, 4, 8, 4, false, false},
    {141, "BC5", Coding::bc5, 4, 4, 16, 4, false, false},
    {142, "BC5 signed", Coding::bc5_signed, 4, 4, 16, 4, false, false},
    {143, "BC6H", Coding::bc6h, 4, 4, 16, 4, false, false},
    {144, "BC6H signed", Coding::bc6h_signed, 4, 4, 16, 4, false, false},
    {145, "BC7", Coding::bc7, 4, 4, 16, 4, false, false},
    {146, "BC7 sRGB", Coding::bc7, 4, 4, 16, 4, false, true},
    {147, "ETC2 RGB", Coding::etc2_rgb, 4, 4, 8, 4, false, false},
    {148, "ETC2 RGB sRGB", Coding::etc2_rgb, 4, 4, 8, 4, false, true},
    {149, "ETC2 RGB A1", Coding::etc2_rgba1, 4, 4, 8, 4, false, false},
    {150, "ETC2 RGB A1 sRGB", Coding::etc2_rgba1, 4, 4, 8, 4, false, true},
    {151, "ETC2 RGBA", Coding::etc2_rgba, 4, 4, 16, 4, false, false},
    {152, "ETC2 RGBA sRGB", Coding::etc2_rgba, 4, 4, 16, 4, false, true},
    {153, "EAC R11", Coding::eac_r, 4, 4, 8, 4, false, false},
    {154, "EAC R11 signed", Coding::eac_r_signed, 4, 4, 8, 4, false, false},
    {155, "EAC RG11", Coding::eac_rg, 4, 4, 16, 4, false, false},
    {156, "EAC RG11 signed", Coding::eac_rg_signed, 4, 4, 16, 4, false, false},
    {157, "ASTC 4x4", Coding::astc, 4, 4, 16, 4, false, false},
    {158, "ASTC 4x4 sRGB", Coding::astc, 4, 4, 16, 4, false, true},
    {159, "ASTC 5x4", Coding::astc, 5, 4, 16, 4, false, false},
    {160, "ASTC 5x4 sRGB", Coding::astc, 5, 4, 16, 4, false, true},
    {161, "ASTC 5x5", Coding::astc, 5, 5, 16, 4, false, false},
    {162, "ASTC 5x5 sRGB", Coding::astc, 5, 5, 16, 4, false, true},
    {163, "ASTC 6x5", Coding::astc, 6, 5, 16, 4, false, false},
    {164, "ASTC 6x5 sRGB", Coding::astc, 6, 5, 16, 4, false, true},
    {165, "ASTC 6x6", Coding::astc, 6, 6, 16, 4, false, false},
    {166, "ASTC 6x6 sRGB", Coding::astc, 6, 6, 16, 4, false, true},
    {167, "ASTC 8x5", Coding::astc, 8, 5, 16, 4, false, false},
    {168, "ASTC 8x5 sRGB", Coding::astc, 8, 5, 16, 4, false, true},
    {169, "ASTC 8x6", Coding::astc, 8, 6, 16, 4, false, false},
    {170, "ASTC 8x6 sRGB", Coding::astc, 8, 6, 16, 4, false, true},
    {171, "ASTC 8x8", Coding::astc, 8, 8, 16, 4, false, false},
    {172, "ASTC 8x8 sRGB", Coding::astc, 8, 8, 16, 4, false, true},
    {173, "ASTC 10x5", Coding::astc, 10, 5, 16, 4, false, false},
    {174, "ASTC 10x5 sRGB", Coding::astc, 10, 5, 16, 4, false, true},
    {175, "ASTC 10x6", Coding::astc, 10, 6, 16, 4, false, false},
    {176, "ASTC 10x6 sRGB", Coding::astc, 10, 6, 16, 4, false, true},
    {177, "ASTC 10x8", Coding::astc, 10, 8, 16, 4, false, false},
    {178, "ASTC 10x8 sRGB", Coding::astc, 10, 8, 16, 4, false, true},
    {179, "ASTC 10x10", Coding::astc, 10, 10, 16, 4, false, false},
    {180, "ASTC 10x10 sRGB", Coding::astc, 10, 10, 16, 4, false, true},
    {181, "ASTC 12x10", Coding::astc, 12, 10, 16, 4, false, false},
    {182, "ASTC 12x10 sRGB", Coding::astc, 12, 10, 16, 4, false, true},
    {183, "ASTC 12x12", Coding::astc, 12, 12, 16, 4, false, false},
    {184, "ASTC 12x12 sRGB", Coding::astc, 12, 12, 16, 4, false, true},
});

} // namespace

const Format kUastcFormat{0, "UASTC", Coding::uastc, 4, 4, 16};

const Format* find_format(std::uint32_t vk_format) {
  const auto found = std::ranges::lower_bound(kFormats, vk_format, {}, &Format::vk_format);
  return found != kFormats.end() && found->vk_format == vk_format ? &*found : nullptr;
}

} // namespace wavepath::ktx
