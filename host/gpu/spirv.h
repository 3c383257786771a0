// The words of SPIR-V that the rewriting of shaders needs (trim_spirv.h, texels_as_storage.h).
#pragma once

#include <cstdint>
#include <span>

namespace wavepath::spirv {

// Opcodes of the SPIR-V specification, section 3.49; the headers of the registry are no package that we need otherwise.
enum Op : std::uint32_t {
  OpSourceContinued = 2,
  OpSource = 3,
  OpSourceExtension = 4,
  OpName = 5,
  OpMemberName = 6,
  OpString = 7,
  OpLine = 8,
  OpExtInst = 12,
  OpEntryPoint = 15,
  OpTypeVoid = 19,
  OpTypeBool = 20,
  OpTypeInt = 21,
  OpTypeFloat = 22,
  OpTypeVector = 23,
  OpTypeImage = 25,
  OpTypeRuntimeArray = 29,
  OpTypeStruct = 30,
  OpTypePointer = 32,
  OpTypeForwardPointer = 39,
  OpConstantTrue = 41,
  OpConstantFalse = 42,
  OpConstant = 43,
  OpSpecConstantTrue = 48,
  OpSpecConstantFalse = 49,
  OpSpecConstant = 50,
  OpSpecConstantOp = 52,
  OpFunction = 54,
  OpFunctionParameter = 55,
  OpFunctionEnd = 56,
  OpFunctionCall = 57,
  OpVariable = 59,
  OpLoad = 61,
  OpAccessChain = 65,
  OpArrayLength = 68,
  OpDecorate = 71,
  OpMemberDecorate = 72,
  OpCompositeConstruct = 80,
  OpCopyObject = 83,
  OpImageFetch = 95,
  OpImageQuerySize = 104,
  OpBitcast = 124,
  OpIAdd = 128,
  OpISub = 130,
  OpIMul = 132,
  OpUDiv = 134,
  OpUMod = 137,
  OpLogicalEqual = 164,
  OpLogicalNotEqual = 165,
  OpLogicalOr = 166,
  OpLogicalAnd = 167,
  OpLogicalNot = 168,
  OpSelect = 169,
  OpIEqual = 170,
  OpINotEqual = 171,
  OpUGreaterThan = 172,
  OpSGreaterThan = 173,
  OpUGreaterThanEqual = 174,
  OpSGreaterThanEqual = 175,
  OpULessThan = 176,
  OpSLessThan = 177,
  OpULessThanEqual = 178,
  OpSLessThanEqual = 179,
  OpShiftRightLogical = 194,
  OpShiftLeftLogical = 196,
  OpBitwiseOr = 197,
  OpBitwiseXor = 198,
  OpBitwiseAnd = 199,
  OpNot = 200,
  OpPhi = 245,
  OpLoopMerge = 246,
  OpSelectionMerge = 247,
  OpLabel = 248,
  OpBranch = 249,
  OpBranchConditional = 250,
  OpSwitch = 251,
  OpKill = 252,
  OpReturn = 253,
  OpReturnValue = 254,
  OpUnreachable = 255,
  OpModuleProcessed = 330,
  OpDecorateId = 332,
  OpTerminateInvocation = 4416,
  OpTypeRayQuery = 4472,
  OpTypeAccelerationStructure = 5341,
};

constexpr std::uint32_t kMagic = 0x07230203, kHeaderWords = 5;
constexpr std::uint32_t kBoundAt = 3;         // the word of the header that all ids are below
constexpr std::uint32_t kSpecId = 1;          // a decoration: the number of a specialization constant
constexpr std::uint32_t kUniformConstant = 0; // the storage class of textures and texel buffers

struct Instruction {
  std::uint32_t op;
  std::span<const std::uint32_t> words; // the first one holds op and length
};

} // namespace wavepath::spirv
