#include "host/convert/mesh_files.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/convert/inflate.h"

namespace wavepath::convert {
namespace {

constexpr std::uint64_t kMostVertices = std::numeric_limits<std::uint32_t>::max();

[[noreturn]] void fail_mesh(const std::string& path, const std::string& problem) {
  throw Error(path, problem, "export the mesh again");
}

// --- PLY ---

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };

std::size_t size_of(PlyType type) {
  constexpr std::size_t kSizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

std::optional<PlyType> ply_type(std::string_view name) {
  constexpr std::pair<std::string_view, PlyType> kNames[] = {
      {"char", PlyType::i8},   {"int8", PlyType::i8},     {"uchar", PlyType::u8},   {"uint8", PlyType::u8},
      {"short", PlyType::i16}, {"int16", PlyType::i16},   {"ushort", PlyType::u16}, {"uint16", PlyType::u16},
      {"int", PlyType::i32},   {"int32", PlyType::i32},   {"uint", PlyType::u32},   {"uint32", PlyType::u32},
      {"float", PlyType::f32}, {"float32", PlyType::f32}, {"double", PlyType::f64}, {"float64", PlyType::f64}};
  for (const auto& [text, type] : kNames)
    if (text == name) return type;
  return std::nullopt;
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  std::optional<PlyType> count; // of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
};

enum class PlyForm : std::uint8_t { ascii, little, big };

// Reads one value after the other of the body of a PLY file.
struct PlyBody {
  const std::string& path;
  const std::uint8_t* at;
  const std::uint8_t* end;
  PlyForm form;

  double value(PlyType type) {
    if (form == PlyForm::ascii) return word();
    const std::size_t size = size_of(type);
    if (static_cast<std::size_t>(end - at) < size) fail_mesh(path, "is cut short");
    std::uint8_t bytes[8];
    std::memcpy(bytes, at, size);
    at += size;
    if (form == PlyForm::big) std::reverse(bytes, bytes + size);
    const auto as = [&]<class T>(T result) {
      std::memcpy(&result, bytes, sizeof(T));
      return static_cast<double>(result);
    };
    switch (type) {
      case PlyType::i8:
        return as(std::int8_t{});
      case PlyType::u8:
        return as(std::uint8_t{});
      case PlyType::i16:
        return as(std::int16_t{});
      case PlyType::u16:
        return as(std::uint16_t{});
      case PlyType::i32:
        return as(std::int32_t{});
      case PlyType::u32:
        return as(std::uint32_t{});
      case PlyType::f32:
        return as(float{});
      case PlyType::f64:
        break;
    }
    return as(double{});
  }

private:
  double word() {
    while (at < end && std::strchr(" \t\r\n", *at)) ++at;
    const char* first = reinterpret_cast<const char*>(at);
    const char* last = reinterpret_cast<const char*>(end);
    if (first < last && *first == '+') ++first;
    double value = 0.0;
    const auto [stop, error] = std::from_chars(first, last, value);
    if (error == std::errc::invalid_argument || stop == first)
      fail_mesh(path, "is cut short, or has a word for a number");
    at = reinterpret_cast<const std::uint8_t*>(stop);
    return value;
  }
};

std::vector<std::string> words_in(std::string_view line) {
  std::vector<std::string> words;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t first = line.find_first_not_of(" \t\r", at);
    if (first == std::string_view::npos) break;
    const std::size_t last = std::min(line.find_first_of(" \t\r", first), line.size());
    words.emplace_back(line.substr(first, last - first));
    at = last;
  }
  return words;
}

PlyProperty to_property(const std::string& path, const std::vector<std::string>& words) {
  const bool is_list = words.size() == 5 && words[1] == "list";
  if (!is_list && words.size() != 3) fail_mesh(path, "has a property that cannot be read");
  PlyProperty property;
  property.name = words.back();
  const std::optional<PlyType> type = ply_type(words[words.size() - 2]);
  if (is_list) property.count = ply_type(words[2]);
  if (!type || (is_list && !property.count)) fail_mesh(path, "has a property of unknown type");
  property.type = *type;
  return property;
}

struct PlyHeader {
  PlyForm form = PlyForm::ascii;
  std::vector<PlyElement> elements;
  std::size_t end = 0; // where the body begins
};

PlyHeader read_header(const std::string& path, std::string_view text) {
  PlyHeader header;
  bool has_form = false;
  for (std::size_t at = 0;;) {
    const std::size_t line_end = text.find('\n', at);
    if (line_end == std::string_view::npos || line_end - at > 65536) fail_mesh(path, "has no whole header");
    const std::vector<std::string> words = words_in(text.substr(at, line_end - at));
    if (at == 0 && (words.size() != 1 || words[0] != "ply")) fail_mesh(path, "is no PLY file");
    at = line_end + 1;
    if (words.empty()) continue;
    if (words[0] == "end_header") {
      header.end = at;
      break;
    }
    if (words[0] == "format" && words.size() >= 2) {
      has_form = true;
      if (words[1] == "binary_little_endian")
        header.form = PlyForm::little;
      else if (words[1] == "binary_big_endian")
        header.form = PlyForm::big;
      else if (words[1] != "ascii")
        fail_mesh(path, "has an unknown format");
    } else if (words[0] == "element" && words.size() == 3) {
      PlyElement element{words[1], 0, {}};
      const char* last = words[2].data() + words[2].size();
      if (std::from_chars(words[2].data(), last, element.count).ptr != last) fail_mesh(path, "has an unreadable count");
      header.elements.push_back(std::move(element));
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(to_property(path, words));
    }
  }
  if (!has_form) fail_mesh(path, "does not say its format");
  return header;
}

// Where a property of a vertex goes: 0 to 2 position, 3 to 5 normal, 6 and 7 texture coordinates, 8 nowhere.
int role_of(const std::string& name) {
  constexpr std::pair<std::string_view, int> kRoles[] = {
      {"x", 0}, {"y", 1}, {"z", 2}, {"nx", 3},        {"ny", 4},        {"nz", 5},        {"u", 6},
      {"v", 7}, {"s", 6}, {"t", 7}, {"texture_u", 6}, {"texture_v", 7}, {"texture_s", 6}, {"texture_t", 7}};
  for (const auto& [text, role] : kRoles)
    if (text == name) return role;
  return 8;
}

void read_vertices(PlyBody& body, const PlyElement& element, bool flips_v, Mesh& mesh) {
  if (element.count > kMostVertices) fail_mesh(body.path, "has more vertices than an index can count");
  std::vector<int> roles;
  bool has[9] = {};
  for (const PlyProperty& property : element.properties) {
    roles.push_back(property.count ? 8 : role_of(property.name));
    has[roles.back()] = true;
  }
  if (!has[0] || !has[1] || !has[2]) fail_mesh(body.path, "has vertices without x, y and z");
  // A value takes at least two bytes as text and one in binary, so that a count is believed within the file alone.
  if (element.count * element.properties.size() > static_cast<std::uint64_t>(body.end - body.at) + 1)
    fail_mesh(body.path, "is cut short");
  const bool has_normals = has[3] && has[4] && has[5], has_uvs = has[6] && has[7];
  for (std::uint64_t i = 0; i < element.count; ++i) {
    float values[9] = {};
    for (std::size_t p = 0; p < roles.size(); ++p) {
      const PlyProperty& property = element.properties[p];
      double count = property.count ? body.value(*property.count) : 1.0;
      for (; count >= 1.0; --count) values[roles[p]] = static_cast<float>(body.value(property.type));
    }
    mesh.positions.emplace_back(values[0], values[1], values[2]);
    if (has_normals) mesh.normals.emplace_back(values[3], values[4], values[5]);
    if (has_uvs) mesh.uvs.emplace_back(values[6], flips_v ? 1.0f - values[7] : values[7]);
  }
}

void add_fan(const std::string& path, Mesh& mesh, const std::vector<std::uint32_t>& polygon) {
  for (const std::uint32_t index : polygon)
    if (index >= mesh.positions.size()) fail_mesh(path, "has a face with a vertex that does not exist");
  for (std::size_t i = 2; i < polygon.size(); ++i)
    mesh.indices.insert(mesh.indices.end(), {polygon[0], polygon[i - 1], polygon[i]});
}

void read_faces(PlyBody& body, const PlyElement& element, Mesh& mesh) {
  std::vector<std::uint32_t> polygon;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const PlyProperty& property : element.properties) {
      if (!property.count) {
        body.value(property.type);
        continue;
      }
      const bool is_polygon = property.name == "vertex_indices" || property.name == "vertex_index";
      polygon.clear();
      for (double count = body.value(*property.count); count >= 1.0; --count) {
        const double index = body.value(property.type);
        if (is_polygon) polygon.push_back(index >= 0.0 && index < 4e9 ? static_cast<std::uint32_t>(index) : ~0u);
      }
      if (is_polygon) add_fan(body.path, mesh, polygon);
    }
    if (element.properties.empty()) break;
  }
}

void skip_element(PlyBody& body, const PlyElement& element) {
  for (std::uint64_t i = 0; i < element.count && !element.properties.empty(); ++i)
    for (const PlyProperty& property : element.properties)
      for (double count = property.count ? body.value(*property.count) : 1.0; count >= 1.0; --count)
        body.value(property.type);
}

// --- OBJ ---

struct ObjReader {
  const std::string& path;
  bool flips_v;
  std::vector<glm::vec3> positions, normals;
  std::vector<glm::vec2> uvs;
  Mesh mesh;
  bool has_normals = true, has_uvs = true;
  std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> vertices;

  [[noreturn]] void fail_line(std::uint64_t line) { fail_mesh(path, fmt::format("line {} cannot be read", line)); }

  int numbers(std::string_view text, float* out, int most) {
    int count = 0;
    const char *at = text.data(), *end = text.data() + text.size();
    while (count < most) {
      while (at < end && (*at == ' ' || *at == '\t' || *at == '+')) ++at;
      double value = 0.0;
      const auto [stop, error] = std::from_chars(at, end, value);
      if (error == std::errc::invalid_argument || stop == at) break;
      out[count++] = static_cast<float>(value);
      at = stop;
    }
    return count;
  }

  // 1 is the first, -1 the last so far; 0 and beyond do not exist.
  static std::uint32_t resolved(std::int64_t index, std::size_t size) {
    const std::int64_t from_zero = index > 0 ? index - 1 : static_cast<std::int64_t>(size) + index;
    return from_zero >= 0 && from_zero < static_cast<std::int64_t>(size) ? static_cast<std::uint32_t>(from_zero) : ~0u;
  }

  std::uint32_t vertex(std::string_view text, std::uint64_t line) {
    std::int64_t numbers_of[3] = {0, 0, 0};
    const char *at = text.data(), *end = text.data() + text.size();
    for (int part = 0; part < 3 && at < end; ++part) {
      if (*at != '/') {
        const auto [stop, error] = std::from_chars(at, end, numbers_of[part]);
        if (error != std::errc()) fail_line(line);
        at = stop;
      }
      if (at < end && *at++ != '/') fail_line(line);
    }
    const std::uint32_t p = resolved(numbers_of[0], positions.size());
    if (p == ~0u) fail_line(line);
    const std::uint32_t t = numbers_of[1] ? resolved(numbers_of[1], uvs.size()) : ~0u;
    const std::uint32_t n = numbers_of[2] ? resolved(numbers_of[2], normals.size()) : ~0u;
    if ((numbers_of[1] && t == ~0u) || (numbers_of[2] && n == ~0u)) fail_line(line);
    const auto [found, is_new] = vertices.try_emplace({p, t, n}, static_cast<std::uint32_t>(mesh.positions.size()));
    if (is_new) {
      has_uvs &= t != ~0u;
      has_normals &= n != ~0u;
      mesh.positions.push_back(positions[p]);
      mesh.uvs.push_back(t != ~0u ? uvs[t] : glm::vec2(0.0f));
      mesh.normals.push_back(n != ~0u ? normals[n] : glm::vec3(0.0f));
    }
    return found->second;
  }

  void read_line(std::string_view text, std::uint64_t line) {
    const std::size_t first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return;
    text.remove_prefix(first);
    text = text.substr(0, text.find_last_not_of(" \t\r") + 1);
    float values[3] = {};
    if (text.starts_with("v ") || text.starts_with("v\t")) {
      if (numbers(text.substr(2), values, 3) < 3) fail_line(line);
      positions.emplace_back(values[0], values[1], values[2]);
    } else if (text.starts_with("vn ")) {
      if (numbers(text.substr(3), values, 3) < 3) fail_line(line);
      normals.emplace_back(values[0], values[1], values[2]);
    } else if (text.starts_with("vt ")) {
      if (numbers(text.substr(3), values, 2) < 1) fail_line(line);
      uvs.emplace_back(values[0], flips_v ? 1.0f - values[1] : values[1]);
    } else if (text.starts_with("f ")) {
      std::vector<std::uint32_t> polygon;
      for (const std::string& word : words_in(text.substr(2))) polygon.push_back(vertex(word, line));
      add_fan(path, mesh, polygon);
    }
  }
};

// --- Mitsuba's serialized meshes ---

struct Cursor {
  const std::string& path;
  std::span<const std::uint8_t> bytes;
  std::size_t at = 0;

  template <class T>
  T take() {
    if (bytes.size() - at < sizeof(T)) fail_mesh(path, "is cut short");
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    at += sizeof(T);
    return value;
  }
};

static_assert(std::endian::native == std::endian::little);

constexpr std::uint16_t kSerializedMagic = 0x041c;
constexpr std::uint32_t kHasNormals = 1, kHasUvs = 2, kHasColors = 8, kDoubles = 0x2000;

// The bytes of one of the meshes, still compressed.
std::span<const std::uint8_t> packed_mesh(const std::string& path, std::span<const std::uint8_t> file,
                                          std::uint32_t index, std::uint16_t version) {
  if (file.size() < 8) fail_mesh(path, "is cut short");
  Cursor tail{path, file, file.size() - 4};
  const auto count = tail.take<std::uint32_t>();
  const std::size_t entry = version >= 4 ? 8 : 4;
  if (index >= count) fail_mesh(path, fmt::format("has no mesh {} among its {}", index, count));
  if (std::uint64_t{count} * entry + 4 > file.size()) fail_mesh(path, "is cut short");
  Cursor table{path, file, file.size() - 4 - count * entry + index * entry};
  const std::uint64_t offset = entry == 8 ? table.take<std::uint64_t>() : table.take<std::uint32_t>();
  if (offset + 4 > file.size()) fail_mesh(path, "has an offset beyond its end");
  return file.subspan(offset + 4);
}

} // namespace

std::vector<std::uint8_t> read_bytes(const std::string& path) {
  std::optional<std::vector<std::uint8_t>> bytes = read_whole_file(path);
  if (!bytes || !regular_file_size(path)) throw Error(path, "cannot be read", "check the name and its permissions");
  if (bytes->size() > 2 && (*bytes)[0] == 0x1f && (*bytes)[1] == 0x8b) return inflated(path, *bytes);
  return std::move(*bytes);
}

Mesh read_ply(const std::string& path, bool flips_v) {
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  const PlyHeader header = read_header(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
  PlyBody body{path, bytes.data() + header.end, bytes.data() + bytes.size(), header.form};
  Mesh mesh;
  for (const PlyElement& element : header.elements) {
    if (element.name == "vertex")
      read_vertices(body, element, flips_v, mesh);
    else if (element.name == "face")
      read_faces(body, element, mesh);
    else
      skip_element(body, element);
  }
  return mesh;
}

Mesh read_obj(const std::string& path, bool flips_v) {
  const std::vector<std::uint8_t> bytes = read_bytes(path);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  ObjReader reader{
      .path = path, .flips_v = flips_v, .positions = {}, .normals = {}, .uvs = {}, .mesh = {}, .vertices = {}};
  std::uint64_t line = 1;
  for (std::size_t at = 0; at < text.size(); ++line) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    reader.read_line(text.substr(at, end - at), line);
    at = end + 1;
  }
  if (!reader.has_normals) reader.mesh.normals.clear();
  if (!reader.has_uvs) reader.mesh.uvs.clear();
  return std::move(reader.mesh);
}

Mesh read_serialized(const std::string& path, std::uint32_t index) {
  const std::vector<std::uint8_t> file = read_bytes(path);
  Cursor head{path, file};
  const auto magic = head.take<std::uint16_t>();
  const auto version = head.take<std::uint16_t>();
  if (magic != kSerializedMagic || version < 3 || version > 4)
    fail_mesh(path, "is no serialized mesh of version 3 or 4");
  const std::vector<std::uint8_t> bytes = inflated(path, packed_mesh(path, file, index, version));
  Cursor data{path, bytes};
  const auto flags = data.take<std::uint32_t>();
  if (version >= 4)
    while (data.take<char>() != 0) {
    }
  const auto vertices = data.take<std::uint64_t>(), triangles = data.take<std::uint64_t>();
  const std::size_t left = bytes.size() - data.at, number = flags & kDoubles ? 8 : 4;
  if (vertices > kMostVertices || vertices > left / number / 3 || triangles > left / 12)
    fail_mesh(path, "is cut short");
  const auto numeric = [&] { return number == 8 ? static_cast<float>(data.take<double>()) : data.take<float>(); };
  const auto triple = [&] {
    const float x = numeric(), y = numeric(), z = numeric();
    return glm::vec3(x, y, z);
  };
  Mesh mesh;
  for (std::uint64_t i = 0; i < vertices; ++i) mesh.positions.push_back(triple());
  for (std::uint64_t i = 0; i < vertices && flags & kHasNormals; ++i) mesh.normals.push_back(triple());
  for (std::uint64_t i = 0; i < vertices && flags & kHasUvs; ++i) {
    const float u = numeric(), v = numeric();
    mesh.uvs.emplace_back(u, v);
  }
  for (std::uint64_t i = 0; i < vertices && flags & kHasColors; ++i) triple();
  for (std::uint64_t i = 0; i < triangles * 3; ++i) {
    mesh.indices.push_back(data.take<std::uint32_t>());
    if (mesh.indices.back() >= vertices) fail_mesh(path, "has a face with a vertex that does not exist");
  }
  return mesh;
}

} // namespace wavepath::convert
