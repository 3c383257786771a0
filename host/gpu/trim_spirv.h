// SPIR-V without the code that its specialization constants leave unreachable. Drivers find that out for themselves,
// but only after they have read, inlined and optimized all of it: lavapipe takes 0.7 s for the kernel that shades the
// Cornell box and 0.16 s for what is left of it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wavepath {

// `spirv` is valid. `constants[i]` is the value of specialization constant i. The module is still to be specialized
// with them, and then computes the same. Branches on what follows from them are taken, cases of switches left out,
// functions that nothing calls dropped, textures and texel buffers that nothing reads, names too. Conditions are
// followed through integers and booleans, phis, and functions that return one value; not through variables. A module of
// another form than glslang writes comes back as it is; layouts lack what kernels do not read once they are trimmed, so
// that such a module may not fit its layout.
std::vector<std::uint32_t> trim_spirv(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> constants);

// Words that two kernels have in common only if they compute the same: trimmed code in which what the constants are has
// been put in and the others are left out; of a module of another form, all of it and all constants. Not for drivers,
// which get the constants beside the code.
std::vector<std::uint32_t> what_spirv_does(std::span<const std::uint32_t> spirv,
                                           std::span<const std::uint32_t> constants);

} // namespace wavepath
