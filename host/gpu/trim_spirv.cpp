// Conditional constant propagation (Wegman and Zadeck 1991), without its lattice: values are followed in the order of
// blocks, in which definitions come before uses, again and again until nothing more is found to be dead.
#include "host/gpu/trim_spirv.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "host/gpu/spirv.h"

namespace wavepath {
namespace {

using namespace spirv;

constexpr std::uint32_t kNowhere = ~0u;

using Value = std::optional<std::uint32_t>; // of an integer of 32 bits or a boolean, where it is known

struct Block {
  std::uint32_t label = 0;
  std::vector<Instruction> code; // without the label; the last one ends it
  bool live = false;
  std::vector<std::uint32_t> exits; // labels, of a live block; without those that are never taken
  const Instruction& end() const { return code.back(); }
  // The merge instruction, if it has one.
  const Instruction* merge() const {
    if (code.size() < 2) return nullptr;
    const Instruction& one = code[code.size() - 2];
    return one.op == OpLoopMerge || one.op == OpSelectionMerge ? &one : nullptr;
  }
};

struct Function {
  std::uint32_t id = 0;
  std::vector<Instruction> head; // OpFunction and parameters
  std::vector<Block> blocks;
  bool called = false;
  Value returned; // where all that it returns is that
};

// Result of an operation on known values; empty for an operation that is not listed here.
Value evaluate(std::uint32_t op, const Value& a, const Value& b, const Value& c) {
  if (op == OpLogicalAnd && ((a && !*a) || (b && !*b))) return 0u;
  if (op == OpLogicalOr && ((a && *a) || (b && *b))) return 1u;
  if ((op == OpBitwiseAnd || op == OpIMul) && ((a && !*a) || (b && !*b))) return 0u;
  if (op == OpSelect) return a ? (*a ? b : c) : Value{};
  if (!a) return {};
  if (op == OpCopyObject || op == OpBitcast) return a;
  if (op == OpLogicalNot) return *a ? 0u : 1u;
  if (op == OpNot) return ~*a;
  if (!b) return {};
  const std::uint32_t x = *a, y = *b;
  const auto sx = static_cast<std::int32_t>(x), sy = static_cast<std::int32_t>(y);
  const auto truth = [](bool holds) { return Value(holds ? 1u : 0u); };
  switch (op) {
    case OpIAdd:
      return x + y;
    case OpISub:
      return x - y;
    case OpIMul:
      return x * y;
    case OpUDiv:
      return y ? Value(x / y) : Value{};
    case OpUMod:
      return y ? Value(x % y) : Value{};
    case OpShiftRightLogical:
      return y < 32 ? Value(x >> y) : Value{};
    case OpShiftLeftLogical:
      return y < 32 ? Value(x << y) : Value{};
    case OpBitwiseOr:
      return x | y;
    case OpBitwiseXor:
      return x ^ y;
    case OpBitwiseAnd:
      return x & y;
    case OpLogicalEqual:
      return truth((x != 0) == (y != 0));
    case OpLogicalNotEqual:
      return truth((x != 0) != (y != 0));
    case OpLogicalOr:
      return truth(x || y);
    case OpLogicalAnd:
      return truth(x && y);
    case OpIEqual:
      return truth(x == y);
    case OpINotEqual:
      return truth(x != y);
    case OpUGreaterThan:
      return truth(x > y);
    case OpUGreaterThanEqual:
      return truth(x >= y);
    case OpULessThan:
      return truth(x < y);
    case OpULessThanEqual:
      return truth(x <= y);
    case OpSGreaterThan:
      return truth(sx > sy);
    case OpSGreaterThanEqual:
      return truth(sx >= sy);
    case OpSLessThan:
      return truth(sx < sy);
    case OpSLessThanEqual:
      return truth(sx <= sy);
    default:
      return {};
  }
}

bool ends_block(std::uint32_t op) { return (op >= OpBranch && op <= OpUnreachable) || op == OpTerminateInvocation; }

class Module {
public:
  Module(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> constants)
      : spirv_(spirv), constants_(constants) {}

  // False if it is not of the form that is understood.
  bool read() {
    if (spirv_.size() < kHeaderWords || spirv_[0] != kMagic) return false;
    const std::uint32_t bound = spirv_[kBoundAt];
    values_.resize(bound);
    is_type_.resize(bound);
    is_scalar_.resize(bound);
    is_boolean_.resize(bound);
    spec_ids_.assign(bound, kNowhere);
    block_of_.assign(bound, kNowhere);
    Function* function = nullptr;
    Block* block = nullptr;
    for (std::size_t at = kHeaderWords; at < spirv_.size();) {
      const std::uint32_t length = spirv_[at] >> 16;
      if (length == 0 || at + length > spirv_.size()) return false;
      const Instruction one{spirv_[at] & 0xffffu, spirv_.subspan(at, length)};
      at += length;
      if (one.op == OpFunction) {
        if (function) return false;
        function = &functions_.emplace_back();
        function->id = one.words[2];
        function->head.push_back(one);
      } else if (!function) {
        read_global(one);
      } else if (one.op == OpFunctionEnd) {
        if (block) return false;
        function = nullptr;
      } else if (one.op == OpLabel) {
        if (block) return false;
        block_of_[one.words[1]] = static_cast<std::uint32_t>(function->blocks.size());
        block = &function->blocks.emplace_back();
        block->label = one.words[1];
      } else if (one.op == OpFunctionParameter) {
        function->head.push_back(one);
      } else if (block && one.op != OpLine) {
        block->code.push_back(one);
        if (ends_block(one.op)) block = nullptr;
      }
    }
    return !function && !functions_.empty() && !is_foreign_ && has_known_form();
  }

  void find_dead_code() {
    function_of_.assign(values_.size(), kNowhere);
    for (std::size_t i = 0; i < functions_.size(); ++i) function_of_[functions_[i].id] = static_cast<std::uint32_t>(i);
    for (bool again = true; again;) { // a function's one value may decide branches of those that call it
      again = false;
      for (Function& function : functions_) {
        follow(function);
        const Value value = returned(function);
        again |= value && !function.returned;
        function.returned = value;
      }
    }
    std::vector<std::uint32_t> waiting;
    const auto call = [&](std::uint32_t id) {
      if (function_of_[id] == kNowhere || functions_[function_of_[id]].called) return;
      functions_[function_of_[id]].called = true;
      waiting.push_back(function_of_[id]);
    };
    for (std::uint32_t entry : entries_) call(entry);
    while (!waiting.empty()) {
      const Function& function = functions_[waiting.back()];
      waiting.pop_back();
      for (const Block& block : function.blocks)
        if (block.live)
          for (const Instruction& one : block.code)
            if (one.op == OpFunctionCall) call(one.words[3]);
    }
  }

  // `settled`: with constants for those that are specialized.
  std::vector<std::uint32_t> write(bool settled) const {
    std::vector<std::uint32_t> code;
    for (const Function& function : functions_)
      if (function.called) write(function, code);
    // Decorations of what is gone have to go too.
    std::vector<bool> in_functions(values_.size()), kept(values_.size());
    for (const Function& function : functions_) {
      for (const Instruction& one : function.head) mark(one, in_functions);
      for (const Block& block : function.blocks)
        for (const Instruction& one : block.code) mark(one, in_functions);
    }
    for (std::size_t at = 0; at < code.size(); at += code[at] >> 16)
      mark({code[at] & 0xffffu, std::span(code).subspan(at, code[at] >> 16)}, kept);
    const std::vector<bool> unread = unread_resources(code);
    const std::vector<bool> read = settled ? read_constants(code) : std::vector<bool>(values_.size(), true);
    std::vector<std::uint32_t> module(spirv_.begin(), spirv_.begin() + kHeaderWords);
    for (const Instruction& one : globals_) {
      if (is_specialized(one) && !read[one.words[2]]) continue;
      if (settled && one.op == OpDecorate && spec_ids_[one.words[1]] != kNowhere) continue;
      const bool decorates = one.op == OpDecorate || one.op == OpMemberDecorate || one.op == OpDecorateId;
      if (decorates && ((in_functions[one.words[1]] && !kept[one.words[1]]) || unread[one.words[1]])) continue;
      if (one.op == OpVariable && unread[one.words[2]]) continue;
      if (one.op == OpEntryPoint)
        put_entry(one, unread, module);
      else if (settled)
        put_settled(one, module);
      else
        put(module, one);
    }
    module.insert(module.end(), code.begin(), code.end());
    return module;
  }

private:
  void read_global(const Instruction& one) {
    const auto w = one.words;
    switch (one.op) {
      case OpSourceContinued:
      case OpSource:
      case OpSourceExtension:
      case OpName:
      case OpMemberName:
      case OpString:
      case OpLine:
      case OpModuleProcessed:
        return; // names
      case OpEntryPoint:
        entries_.push_back(w[2]);
        break;
      case OpDecorate:
        if (w[2] == kSpecId) spec_ids_[w[1]] = w[3];
        break;
      case OpTypeBool:
        is_scalar_[w[1]] = is_boolean_[w[1]] = true;
        break;
      case OpTypeInt:
        is_scalar_[w[1]] = w[2] == 32;
        is_foreign_ |= w[2] > 32; // switches over them have other words
        break;
      case OpExtInst: // of no semantics, which refers to the names
        is_foreign_ = true;
        break;
      case OpConstantTrue:
      case OpConstantFalse:
        values_[w[2]] = one.op == OpConstantTrue ? 1u : 0u;
        break;
      case OpSpecConstantTrue:
      case OpSpecConstantFalse:
        values_[w[2]] = given(w[2], one.op == OpSpecConstantTrue ? 1u : 0u) ? 1u : 0u;
        break;
      case OpConstant:
      case OpSpecConstant:
        if (is_scalar_[w[1]]) values_[w[2]] = one.op == OpConstant ? w[3] : given(w[2], w[3]);
        break;
      case OpSpecConstantOp:
        if (is_scalar_[w[1]]) values_[w[2]] = value_of(w[3], w.subspan(4));
        break;
      default:
        break;
    }
    const bool traces = one.op == OpTypeRayQuery || one.op == OpTypeAccelerationStructure;
    if ((one.op >= OpTypeVoid && one.op < OpTypeForwardPointer) || traces) is_type_[w[1]] = true;
    globals_.push_back(one);
  }

  // Value of a specialization constant.
  std::uint32_t given(std::uint32_t id, std::uint32_t otherwise) const {
    return spec_ids_[id] < constants_.size() ? constants_[spec_ids_[id]] : otherwise;
  }

  Value value_of(std::uint32_t op, std::span<const std::uint32_t> operands) const {
    const auto operand = [&](std::size_t i) { // those of an operation that evaluate() does not know may be no ids
      return i < operands.size() && operands[i] < values_.size() ? values_[operands[i]] : Value{};
    };
    return evaluate(op, operand(0), operand(1), operand(2));
  }

  // A loop whose header has phis would want values from the stand-in for its dead continue block. A branch that does
  // not merge has to leave a loop: one that leaves a selection would be left without it where that is folded.
  bool has_known_form() const {
    std::vector<bool> of_loops(values_.size()); // labels that loops name
    for (const Function& function : functions_)
      for (const Block& block : function.blocks)
        if (const Instruction* merge = block.code.empty() ? nullptr : block.merge(); merge && merge->op == OpLoopMerge)
          of_loops[merge->words[1]] = of_loops[merge->words[2]] = true;
    for (const Function& function : functions_) {
      if (function.blocks.empty()) return false;
      for (const Block& block : function.blocks) {
        if (block.code.empty()) return false;
        const Instruction* merge = block.merge();
        if (merge && merge->op == OpLoopMerge && block.code.front().op == OpPhi) return false;
        const auto w = block.end().words;
        if (block.end().op == OpBranchConditional && !merge && !of_loops[w[2]] && !of_loops[w[3]]) return false;
      }
    }
    return true;
  }

  // Finds the blocks that can be reached, and from where.
  void follow(Function& function) {
    if (function.blocks.empty()) return;
    for (Block& block : function.blocks) block.live = false;
    function.blocks.front().live = true;
    for (bool again = true; again;) {
      again = false;
      for (Block& block : function.blocks) {
        if (!block.live) continue;
        for (const Instruction& one : block.code) learn(function, block, one);
        block.exits = exits(block);
        for (std::uint32_t label : block.exits) {
          Block& next = function.blocks[block_of_[label]];
          again |= !next.live && &next < &block; // else this round comes to it
          next.live = true;
        }
      }
    }
  }

  void learn(const Function& function, const Block& block, const Instruction& one) {
    const auto w = one.words;
    if (w.size() < 3 || !is_type_[w[1]] || !is_scalar_[w[1]]) return;
    if (one.op == OpPhi)
      values_[w[2]] = phi(function, block, w.subspan(3));
    else if (one.op == OpFunctionCall)
      values_[w[2]] = function_of_[w[3]] == kNowhere ? Value{} : functions_[function_of_[w[3]]].returned;
    else
      values_[w[2]] = value_of(one.op, w.subspan(3));
  }

  Value phi(const Function& function, const Block& block, std::span<const std::uint32_t> pairs) const {
    Value common;
    for (std::size_t i = 0; i + 1 < pairs.size(); i += 2) {
      const Block& from = function.blocks[block_of_[pairs[i + 1]]];
      if (&from >= &block) return {}; // comes round a loop
      if (!leads(from, block.label)) continue;
      const Value& value = values_[pairs[i]];
      if (!value || (common && *common != *value)) return {};
      common = value;
    }
    return common;
  }

  static bool leads(const Block& from, std::uint32_t label) {
    return from.live && std::ranges::count(from.exits, label) > 0;
  }

  // The condition of a branch or switch that merges, where it is known: others leave loops, which have to keep their
  // form.
  Value condition(const Block& block) const {
    const Instruction* merge = block.merge();
    const bool decides = block.end().op == OpBranchConditional || block.end().op == OpSwitch;
    return decides && merge && merge->op == OpSelectionMerge ? values_[block.end().words[1]] : Value{};
  }

  std::vector<std::uint32_t> exits(const Block& block) const {
    const auto w = block.end().words;
    const Value known = condition(block);
    switch (block.end().op) {
      case OpBranch:
        return {w[1]};
      case OpBranchConditional:
        if (known) return {w[*known ? 2 : 3]};
        return {w[2], w[3]};
      case OpSwitch: {
        std::vector<std::uint32_t> labels{w[2]};
        for (std::size_t i = 3; i + 1 < w.size(); i += 2) {
          if (known && *known == w[i]) return {w[i + 1]};
          if (!known) labels.push_back(w[i + 1]);
        }
        return labels;
      }
      default:
        return {};
    }
  }

  Value returned(const Function& function) const {
    Value common;
    for (const Block& block : function.blocks) {
      if (!block.live || block.end().op != OpReturnValue) continue;
      const Value& value = values_[block.end().words[1]];
      if (!value || (common && *common != *value)) return {};
      common = value;
    }
    return common;
  }

  static void put(std::vector<std::uint32_t>& code, std::uint32_t op, std::initializer_list<std::uint32_t> operands) {
    code.push_back(static_cast<std::uint32_t>(operands.size() + 1) << 16 | op);
    code.insert(code.end(), operands);
  }
  static void put(std::vector<std::uint32_t>& code, const Instruction& one) {
    code.insert(code.end(), one.words.begin(), one.words.end());
  }

  // Blocks that are left, by position: those that can be reached, and those that headers name. Dominators come first,
  // as they have to, which a case that is now only run into from a later one would not.
  void visit(const Function& function, std::uint32_t at, std::vector<bool>& seen,
             std::vector<std::uint32_t>& reversed) const {
    if (seen[at]) return;
    seen[at] = true;
    const Block& block = function.blocks[at];
    if (block.live) {
      const Instruction* merge = is_folded(block) ? nullptr : block.merge();
      for (std::size_t i = 1; merge && i < (merge->op == OpLoopMerge ? 3u : 2u); ++i)
        visit(function, block_of_[merge->words[i]], seen, reversed);
      for (auto exit = block.exits.rbegin(); exit != block.exits.rend(); ++exit)
        visit(function, block_of_[*exit], seen, reversed);
    }
    reversed.push_back(at);
  }

  void write(const Function& function, std::vector<std::uint32_t>& code) const {
    for (const Instruction& one : function.head) put(code, one);
    std::vector<bool> seen(function.blocks.size());
    std::vector<std::uint32_t> reversed, back_to(function.blocks.size(), kNowhere);
    visit(function, 0, seen, reversed);
    for (const Block& block : function.blocks)
      if (block.live && block.merge() && block.merge()->op == OpLoopMerge)
        back_to[block_of_[block.merge()->words[2]]] = block.label;
    for (auto at = reversed.rbegin(); at != reversed.rend(); ++at) {
      const Block& block = function.blocks[*at];
      put(code, OpLabel, {block.label});
      // Where a dead merge block begins, nothing is reached, and a dead continue block goes back to its header.
      if (block.live)
        write(function, block, code);
      else if (back_to[*at] != kNowhere)
        put(code, OpBranch, {back_to[*at]});
      else
        put(code, OpUnreachable, {});
    }
    put(code, OpFunctionEnd, {});
  }

  // Textures and texel buffers that the code left does not name: their bindings need not be there. A number that
  // happens to be the same keeps one.
  std::vector<bool> unread_resources(const std::vector<std::uint32_t>& code) const {
    std::vector<bool> unread(values_.size());
    for (const Instruction& one : globals_)
      if (one.op == OpVariable && one.words[3] == kUniformConstant) unread[one.words[2]] = true;
    for (std::size_t at = 0; at < code.size(); at += code[at] >> 16)
      for (const std::uint32_t word : std::span(code).subspan(at + 1, (code[at] >> 16) - 1))
        if (word < unread.size()) unread[word] = false;
    return unread;
  }

  static bool is_specialized(const Instruction& one) {
    return one.op >= OpSpecConstantTrue && one.op <= OpSpecConstantOp;
  }

  // By id: constants that are specialized, or follow from those, and that something reads: the code left, or another
  // global instruction. A number that happens to be the same keeps one.
  std::vector<bool> read_constants(const std::vector<std::uint32_t>& code) const {
    std::vector<bool> read(values_.size());
    const auto mark_all = [&](std::span<const std::uint32_t> words) {
      for (const std::uint32_t word : words)
        if (word < read.size()) read[word] = true;
    };
    for (std::size_t at = 0; at < code.size(); at += code[at] >> 16)
      mark_all(std::span(code).subspan(at + 1, (code[at] >> 16) - 1));
    for (auto one = globals_.rbegin(); one != globals_.rend(); ++one) { // what defines comes before what reads
      const auto w = one->words;
      if (one->op == OpDecorate || one->op == OpMemberDecorate) continue; // they come before
      if (!is_specialized(*one))
        mark_all(w.subspan(1));
      else if (read[w[2]] && !(one->op == OpSpecConstantOp && values_[w[2]]))
        mark_all(w.subspan(3));
    }
    return read;
  }

  // A global instruction; a constant that is specialized with the value that it gets.
  void put_settled(const Instruction& one, std::vector<std::uint32_t>& module) const {
    const auto w = one.words;
    if (one.op == OpSpecConstant && w.size() == 4) return put(module, OpConstant, {w[1], w[2], given(w[2], w[3])});
    const bool known = one.op == OpSpecConstantTrue || one.op == OpSpecConstantFalse || one.op == OpSpecConstantOp;
    if (!known || !values_[w[2]]) return put(module, one);
    if (is_boolean_[w[1]])
      put(module, *values_[w[2]] ? OpConstantTrue : OpConstantFalse, {w[1], w[2]});
    else
      put(module, OpConstant, {w[1], w[2], *values_[w[2]]});
  }

  // An entry point lists the variables that it uses, after its name, whose last word holds a zero byte.
  static void put_entry(const Instruction& one, const std::vector<bool>& unread, std::vector<std::uint32_t>& module) {
    std::size_t at = 3;
    while (at < one.words.size() && one.words[at] >> 24 != 0) ++at;
    const std::size_t begin = module.size();
    module.insert(module.end(), one.words.begin(), one.words.begin() + static_cast<std::ptrdiff_t>(at + 1));
    for (const std::uint32_t id : one.words.subspan(at + 1))
      if (!unread[id]) module.push_back(id);
    module[begin] = static_cast<std::uint32_t>(module.size() - begin) << 16 | OpEntryPoint;
  }

  bool is_folded(const Block& block) const { return block.end().op == OpBranchConditional && condition(block); }

  void write(const Function& function, const Block& block, std::vector<std::uint32_t>& code) const {
    const bool folded = is_folded(block);
    for (const Instruction& one : block.code) {
      if (one.op == OpPhi) {
        std::vector<std::uint32_t> pairs;
        for (std::size_t i = 3; i + 1 < one.words.size(); i += 2) {
          if (!leads(function.blocks[block_of_[one.words[i + 1]]], block.label)) continue;
          pairs.push_back(one.words[i]);
          pairs.push_back(one.words[i + 1]);
        }
        code.push_back(static_cast<std::uint32_t>(pairs.size() + 3) << 16 | OpPhi);
        code.insert(code.end(), {one.words[1], one.words[2]});
        code.insert(code.end(), pairs.begin(), pairs.end());
      } else if (&one == block.merge() && folded) {
        continue;
      } else if (&one == &block.end() && folded) {
        put(code, OpBranch, {block.exits.front()});
      } else if (&one == &block.end() && one.op == OpSwitch && condition(block)) {
        put(code, OpSwitch, {one.words[1], block.exits.front()}); // a case may leave it from within
      } else {
        put(code, one);
      }
    }
  }

  // Marks what an instruction of a function defines.
  void mark(const Instruction& one, std::vector<bool>& ids) const {
    if (one.op == OpLabel)
      ids[one.words[1]] = true;
    else if (one.words.size() >= 3 && is_type_[one.words[1]])
      ids[one.words[2]] = true;
  }

  std::span<const std::uint32_t> spirv_, constants_;
  std::vector<Instruction> globals_; // all before the functions that is no name
  std::vector<Function> functions_;
  std::vector<std::uint32_t> entries_; // functions
  // Indexed by id.
  std::vector<Value> values_;
  std::vector<bool> is_type_, is_scalar_, is_boolean_;
  bool is_foreign_ = false;
  std::vector<std::uint32_t> spec_ids_, block_of_, function_of_;
};

} // namespace

std::vector<std::uint32_t> trim_spirv(std::span<const std::uint32_t> spirv, std::span<const std::uint32_t> constants) {
  Module module(spirv, constants);
  if (!module.read()) return {spirv.begin(), spirv.end()};
  module.find_dead_code();
  return module.write(false);
}

std::vector<std::uint32_t> what_spirv_does(std::span<const std::uint32_t> spirv,
                                           std::span<const std::uint32_t> constants) {
  Module module(spirv, constants);
  if (module.read()) {
    module.find_dead_code();
    return module.write(true);
  }
  std::vector<std::uint32_t> words(spirv.begin(), spirv.end());
  words.insert(words.end(), constants.begin(), constants.end());
  return words;
}

} // namespace wavepath
