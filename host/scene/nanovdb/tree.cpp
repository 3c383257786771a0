// Node for node, each is looked at only after its place is known to lie within the grid.
#include "host/scene/nanovdb/tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <tuple>

#include <fmt/format.h>
#include <nanovdb/NanoVDB.h>

#include "host/base/error.h"

namespace wavepath::nvdb {
namespace {

constexpr std::uint64_t kAlignment = NANOVDB_DATA_ALIGNMENT;
constexpr unsigned kMostBitsExponent = 4; // FpN: values of 2^4 bits

[[noreturn]] void fail_tree(const std::string& file, const std::string& what, const std::string& problem) {
  throw Error(file, what + " " + problem, "copy or download it again, or convert it anew by nanovdb_convert");
}

// Storage of a struct of NanoVDB, none of which can be constructed.
template <class T>
class Raw {
public:
  void copy_from(const std::uint8_t* bytes, std::size_t size = sizeof(T)) { std::memcpy(storage_, bytes, size); }
  const T& operator*() const { return *reinterpret_cast<const T*>(storage_); }
  const T* operator->() const { return &**this; }

private:
  // Leaves of FpN are followed by their values, 64 bytes for each bit.
  alignas(T) std::uint8_t storage_[sizeof(T) + (64u << kMostBitsExponent)];
};

template <class Build>
void decode_leaf(const std::uint8_t* bytes, float* out) {
  using Data = typename nanovdb::NanoLeaf<Build>::DataType;
  Raw<Data> leaf;
  if constexpr (std::is_same_v<Build, nanovdb::FpN>) {
    leaf.copy_from(bytes);
    leaf.copy_from(bytes, leaf->memUsage());
  } else {
    leaf.copy_from(bytes);
  }
  for (std::uint32_t i = 0; i < kBrickVoxels; ++i) out[i] = static_cast<float>(leaf->getValue(i));
}

template <class Build>
class TreeReader {
  using Root = typename nanovdb::NanoRoot<Build>::DataType;
  using Upper = typename nanovdb::NanoUpper<Build>::DataType;
  using Lower = typename nanovdb::NanoLower<Build>::DataType;
  using LeafData = typename nanovdb::NanoLeaf<Build>::DataType;

public:
  TreeReader(const std::string& file, const std::string& what, std::span<const std::uint8_t> bytes)
      : file_(file),
        what_(what),
        bytes_(bytes),
        uppers_left_(bytes.size() / sizeof(Upper)),
        lowers_left_(bytes.size() / sizeof(Lower)),
        leaves_left_(bytes.size() / sizeof(LeafData)) {}

  Tree read(std::uint64_t root) {
    tree_.decode = decode_leaf<Build>;
    check(root, sizeof(Root));
    Raw<Root> data;
    data.copy_from(bytes_.data() + root);
    tree_.background = static_cast<float>(data->mBackground);
    const std::uint64_t count = data->mTableSize, size = count * sizeof(typename Root::Tile);
    check(root, sizeof(Root) + size);
    std::vector<glm::ivec3> seen;
    for (std::uint64_t i = 0; i < count; ++i) {
      typename Root::Tile tile;
      std::memcpy(static_cast<void*>(&tile), bytes_.data() + root + sizeof(Root) + i * sizeof(tile), sizeof(tile));
      const nanovdb::Coord origin = Root::KeyToCoord(tile.key);
      const glm::ivec3 first(origin[0], origin[1], origin[2]);
      seen.push_back(first);
      if (tile.child == 0)
        add_tile(first, 4096, static_cast<float>(tile.value));
      else
        read_upper(first, child_of(root, tile.child));
    }
    const auto key = [](const glm::ivec3& p) { return std::tuple(p.x, p.y, p.z); };
    std::ranges::sort(seen, {}, key);
    if (std::ranges::adjacent_find(seen) != seen.end()) fail("has two nodes for one place");
    return std::move(tree_);
  }

private:
  [[noreturn]] void fail(const std::string& problem) const { fail_tree(file_, what_, problem); }

  void check(std::uint64_t offset, std::uint64_t size) const {
    if (offset % kAlignment != 0 || offset > bytes_.size() || size > bytes_.size() - offset)
      fail("has a node outside of its data");
  }

  // Offsets are signed and relative to the node that holds them; one that wraps around is refused by check().
  static std::uint64_t child_of(std::uint64_t node, std::int64_t offset) {
    return node + static_cast<std::uint64_t>(offset);
  }

  // Nodes that several others share would make a small file large.
  void count(std::uint64_t& left) const {
    if (left-- == 0) fail("has more nodes than fit into its data");
  }

  void add_tile(const glm::ivec3& first, int side, float value) {
    if (value != tree_.background) tree_.tiles.push_back({first, side, value}); // true for NaN
  }

  // `Node` of 2^bits children a side, each of `side` voxels.
  template <class Node, class Child>
  void read_node(const glm::ivec3& first, std::uint64_t offset, int bits, int side, const Child& child) {
    check(offset, sizeof(Node));
    const auto node = std::make_unique<Raw<Node>>();
    node->copy_from(bytes_.data() + offset);
    const Node& data = **node;
    const int mask = (1 << bits) - 1;
    for (std::uint32_t n = 0; n < 1u << (3 * bits); ++n) {
      const auto i = static_cast<int>(n);
      const glm::ivec3 place = first + side * glm::ivec3(i >> (2 * bits), (i >> bits) & mask, i & mask);
      if (data.mChildMask.isOn(n))
        child(place, child_of(offset, data.mTable[n].child));
      else
        add_tile(place, side, static_cast<float>(data.mTable[n].value));
    }
  }

  void read_upper(const glm::ivec3& first, std::uint64_t offset) {
    count(uppers_left_);
    read_node<Upper>(first, offset, 5, 128, [&](const glm::ivec3& place, std::uint64_t at) { read_lower(place, at); });
  }

  void read_lower(const glm::ivec3& first, std::uint64_t offset) {
    count(lowers_left_);
    read_node<Lower>(first, offset, 4, 8, [&](const glm::ivec3& place, std::uint64_t at) { add_leaf(place, at); });
  }

  void add_leaf(const glm::ivec3& first, std::uint64_t offset) {
    count(leaves_left_);
    check(offset, sizeof(LeafData));
    if constexpr (std::is_same_v<Build, nanovdb::FpN>) {
      Raw<LeafData> leaf;
      leaf.copy_from(bytes_.data() + offset);
      if (leaf->mFlags >> 5 > kMostBitsExponent) fail("has values of more than 16 bits");
      check(offset, leaf->memUsage());
    }
    tree_.leaves.push_back({first, offset});
  }

  const std::string& file_;
  const std::string& what_;
  std::span<const std::uint8_t> bytes_;
  std::uint64_t uppers_left_, lowers_left_, leaves_left_;
  Tree tree_;
};

glm::dmat4 matrix_of(const nanovdb::Map& map) {
  glm::dmat4 matrix(1.0);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) matrix[column][row] = map.mMatD[3 * row + column];
    matrix[3][row] = map.mVecD[row];
  }
  return matrix;
}

bool is_invertible(const glm::dmat4& matrix) {
  const glm::dmat4 inverse = glm::inverse(matrix);
  for (int i = 0; i < 4; ++i)
    for (int j = 0; j < 4; ++j)
      if (!std::isfinite(matrix[i][j]) || !std::isfinite(inverse[i][j])) return false;
  return true;
}

template <class Build>
Tree read_typed(const std::string& file, const std::string& what, std::span<const std::uint8_t> bytes,
                std::uint64_t root) {
  return TreeReader<Build>(file, what, bytes).read(root);
}

using Reader = Tree (*)(const std::string&, const std::string&, std::span<const std::uint8_t>, std::uint64_t);

Reader reader_of(std::uint32_t type) {
  switch (static_cast<nanovdb::GridType>(type)) {
    case nanovdb::GridType::Float:
      return read_typed<float>;
    case nanovdb::GridType::Double:
      return read_typed<double>;
    case nanovdb::GridType::Fp4:
      return read_typed<nanovdb::Fp4>;
    case nanovdb::GridType::Fp8:
      return read_typed<nanovdb::Fp8>;
    case nanovdb::GridType::Fp16:
      return read_typed<nanovdb::Fp16>;
    case nanovdb::GridType::FpN:
      return read_typed<nanovdb::FpN>;
    default:
      return nullptr;
  }
}

} // namespace

bool holds_scalars(std::uint32_t type) { return reader_of(type) != nullptr; }

std::string type_name(std::uint32_t type) {
  const bool known = type > 0 && type < static_cast<std::uint32_t>(nanovdb::GridType::End);
  return known ? nanovdb::toStr(static_cast<nanovdb::GridType>(type)) : fmt::format("number {}", type);
}

Tree read_tree(const std::string& file, const std::string& what, std::span<const std::uint8_t> bytes) {
  struct Head {
    nanovdb::GridData grid;
    nanovdb::TreeData<3> tree;
  };
  if (bytes.size() < sizeof(Head)) fail_tree(file, what, "is too short");
  const auto head = std::make_unique<Raw<Head>>();
  head->copy_from(bytes.data());
  const nanovdb::GridData& grid = (*head)->grid;
  const auto type = static_cast<std::uint32_t>(grid.mGridType);
  const Reader reader = reader_of(type);
  if (!reader) fail_tree(file, what, "holds values of type " + type_name(type));
  Tree tree = reader(file, what, bytes, sizeof(nanovdb::GridData) + (*head)->tree.mNodeOffset[3]);
  tree.bytes = bytes;
  tree.grid_from_index = matrix_of(grid.mMap);
  if (!is_invertible(tree.grid_from_index)) fail_tree(file, what, "has a matrix that cannot be inverted");
  return tree;
}

} // namespace wavepath::nvdb
