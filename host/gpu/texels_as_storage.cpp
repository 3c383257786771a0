#include "host/gpu/texels_as_storage.h"

#include <algorithm>
#include <initializer_list>
#include <map>

#include "host/base/error.h"
#include "host/gpu/spirv.h"

namespace wavepath {
namespace {

using namespace spirv;

enum Decoration : std::uint32_t { kBlock = 2, kArrayStride = 6, kNonWritable = 24, kBinding = 33, kOffset = 35 };
constexpr std::uint32_t kStorageBuffer = 12;          // a storage class
constexpr std::uint32_t kDimBuffer = 5, kSampled = 1; // of OpTypeImage

struct TexelBlock {
  std::uint32_t components = 4, slot = 0;
  std::uint32_t component = 0; // type id: of uints or floats
  std::uint32_t element = 0;   // type ids: of the component or of a vector of them,
  std::uint32_t pointer = 0;   // and of a pointer to it
};

class Rewriter {
public:
  Rewriter(std::span<const std::uint32_t> spirv, std::span<const StorageTexels> texels)
      : spirv_(spirv), texels_(texels), bound_(spirv[kBoundAt]) {}

  std::vector<std::uint32_t> run() {
    find_blocks();
    if (blocks_.empty()) return {spirv_.begin(), spirv_.end()};
    out_.assign(spirv_.begin(), spirv_.begin() + kHeaderWords);
    bool in_functions = false, decorated = false;
    declare();
    for_each([&](const Instruction& one) {
      if ((one.op == OpDecorate || one.op == OpMemberDecorate) && !decorated) {
        out_.insert(out_.end(), decorations_.begin(), decorations_.end());
        decorated = true;
      }
      if (one.op == OpFunction && !in_functions) {
        out_.insert(out_.end(), declarations_.begin(), declarations_.end());
        in_functions = true;
      }
      if (one.op == OpVariable && blocks_.contains(one.words[2])) return;
      if (one.op == OpDecorate && one.words[2] == kBinding && blocks_.contains(one.words[1]))
        put(out_, OpDecorate, {one.words[1], kBinding, blocks_[one.words[1]].slot});
      else if (in_functions)
        rewrite(one);
      else
        keep(one);
    });
    out_[kBoundAt] = bound_;
    return std::move(out_);
  }

private:
  template <typename Visit>
  void for_each(const Visit& visit) const {
    for (std::size_t at = kHeaderWords; at < spirv_.size(); at += spirv_[at] >> 16)
      visit(Instruction{spirv_[at] & 0xffffu, spirv_.subspan(at, spirv_[at] >> 16)});
  }

  // The variables to be rewritten, and the types that are there.
  void find_blocks() {
    std::map<std::uint32_t, std::uint32_t> slots, components_of_image, pointed;
    for_each([&](const Instruction& one) {
      const auto w = one.words;
      if (one.op == OpDecorate && w[2] == kBinding) slots[w[1]] = w[3];
      if (one.op == OpTypeInt && w[2] == 32 && w[3] == 0) uint_ = w[1];
      if (one.op == OpTypeFloat && w[2] == 32) float_ = w[1];
      if (one.op == OpTypeVector) vectors_[{w[2], w[3]}] = w[1];
      if (one.op == OpTypeImage && w[3] == kDimBuffer && w[7] == kSampled) components_of_image[w[1]] = w[2];
      if (one.op == OpTypePointer && w[2] == kUniformConstant) pointed[w[1]] = w[3];
      if (one.op != OpVariable || w[3] != kUniformConstant) return;
      const auto image = components_of_image.find(pointed[w[1]]);
      const auto slot = slots.find(w[2]);
      if (image == components_of_image.end() || slot == slots.end()) return;
      for (const StorageTexels& texels : texels_)
        if (texels.slot == slot->second) blocks_[w[2]] = {texels.components, texels.block, image->second};
    });
  }

  void declare() {
    if (!uint_) put(declarations_, OpTypeInt, {uint_ = next(), 32, 0});
    zero_ = constant(uint_, 0);
    for (auto& [variable, block] : blocks_) {
      const std::uint32_t array = next(), whole = next(), pointer = next();
      block.element = block.components == 1 ? block.component : vector(block.component, block.components);
      block.pointer = next();
      put(declarations_, OpTypePointer, {block.pointer, kStorageBuffer, block.element});
      put(declarations_, OpTypeRuntimeArray, {array, block.element});
      put(declarations_, OpTypeStruct, {whole, array});
      put(declarations_, OpTypePointer, {pointer, kStorageBuffer, whole});
      put(declarations_, OpVariable, {pointer, variable, kStorageBuffer});
      put(decorations_, OpDecorate, {array, kArrayStride, block.components * 4});
      put(decorations_, OpDecorate, {whole, kBlock});
      put(decorations_, OpMemberDecorate, {whole, 0, kOffset, 0});
      put(decorations_, OpMemberDecorate, {whole, 0, kNonWritable});
      if (block.components == 4) continue;
      constexpr std::uint32_t kOne = 1, kFloatOne = 0x3f800000;
      fill(block.component, block.component == float_ ? kFloatOne : kOne);
    }
  }

  // Values of the components that an element lacks.
  void fill(std::uint32_t component, std::uint32_t one) {
    if (!zeros_.contains(component))
      zeros_[component] = constant(component, 0), ones_[component] = constant(component, one);
  }

  void rewrite(const Instruction& one) {
    const auto w = one.words;
    if (one.op == OpLoad && blocks_.contains(w[3])) {
      loaded_[w[2]] = w[3];
    } else if (one.op == OpImageFetch && loaded_.contains(w[3])) {
      fetch(loaded_[w[3]], w[1], w[2], w[4]);
    } else if (one.op == OpImageQuerySize && loaded_.contains(w[3])) {
      const std::uint32_t length = next();
      put(out_, OpArrayLength, {uint_, length, loaded_[w[3]], 0});
      put(out_, OpBitcast, {w[1], w[2], length});
    } else {
      keep(one);
    }
  }

  void fetch(std::uint32_t variable, std::uint32_t type, std::uint32_t result, std::uint32_t index) {
    const TexelBlock& block = blocks_[variable];
    const std::uint32_t pointer = next();
    put(out_, OpAccessChain, {block.pointer, pointer, variable, zero_, index});
    if (block.components == 4) return put(out_, OpLoad, {type, result, pointer});
    const std::uint32_t element = next(), zero = zeros_[block.component], one = ones_[block.component];
    put(out_, OpLoad, {block.element, element, pointer});
    if (block.components == 2)
      put(out_, OpCompositeConstruct, {type, result, element, zero, one});
    else
      put(out_, OpCompositeConstruct, {type, result, element, zero, zero, one});
  }

  // Anything else must not name what is gone. Literals may look like it, in instructions that take no image.
  void keep(const Instruction& one) {
    const bool takes_image = (one.op >= kFirstImageOp && one.op <= kLastImageOp) || one.op == OpFunctionCall;
    if (takes_image &&
        std::ranges::any_of(one.words.subspan(1), [&](std::uint32_t id) { return loaded_.contains(id); }))
      throw Error("shader", "a texel buffer is read by other means than texelFetch() and textureSize()",
                  "report this as a bug");
    out_.insert(out_.end(), one.words.begin(), one.words.end());
  }

  std::uint32_t vector(std::uint32_t component, std::uint32_t components) {
    std::uint32_t& type = vectors_[{component, components}];
    if (!type) put(declarations_, OpTypeVector, {type = next(), component, components});
    return type;
  }

  std::uint32_t constant(std::uint32_t type, std::uint32_t value) {
    const std::uint32_t id = next();
    put(declarations_, OpConstant, {type, id, value});
    return id;
  }

  static void put(std::vector<std::uint32_t>& code, std::uint32_t op, std::initializer_list<std::uint32_t> operands) {
    code.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16 | op);
    code.insert(code.end(), operands);
  }

  std::uint32_t next() { return bound_++; }

  static constexpr std::uint32_t kFirstImageOp = 86, kLastImageOp = 107; // OpSampledImage to OpImageQuerySamples

  std::span<const std::uint32_t> spirv_;
  std::span<const StorageTexels> texels_;
  std::uint32_t bound_, uint_ = 0, float_ = 0, zero_ = 0;
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> vectors_; // by type and number of components
  std::map<std::uint32_t, TexelBlock> blocks_;                               // by variable
  std::map<std::uint32_t, std::uint32_t> loaded_, zeros_, ones_;             // variables by image; constants by type
  std::vector<std::uint32_t> decorations_, declarations_, out_;
};

} // namespace

std::vector<std::uint32_t> texels_as_storage(std::span<const std::uint32_t> spirv,
                                             std::span<const StorageTexels> texels) {
  if (texels.empty() || spirv.size() < kHeaderWords) return {spirv.begin(), spirv.end()};
  return Rewriter(spirv, texels).run();
}

} // namespace wavepath
