// Builds tiny glTF files for tests: a JSON document that the test edits freely, and one buffer behind it.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace wavepath::test {

// A folder of its own for each test, removed at the end.
class TempFolder {
public:
  TempFolder() {
    static int count = 0;
    path_ = std::filesystem::temp_directory_path() /
            ("wavepath-" + std::to_string(getpid()) + "-" + std::to_string(count++));
    std::filesystem::create_directories(path_);
  }
  ~TempFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TempFolder(TempFolder&&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& contents) const {
    std::filesystem::create_directories((path_ / name).parent_path());
    std::ofstream(path_ / name, std::ios::binary) << contents;
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

enum Component { kByte = 5120, kUbyte, kShort, kUshort, kUint = 5125, kFloat };

struct GltfBuilder {
  nlohmann::json root = {{"asset", {{"version", "2.0"}}}};
  std::string bytes; // of buffer 0

  int add(const char* list, nlohmann::json item) {
    root[list].push_back(std::move(item));
    return static_cast<int>(root[list].size()) - 1;
  }
  int view(const std::string& contents, int stride = 0) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    nlohmann::json view = {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", contents.size()}};
    if (stride) view["byteStride"] = stride;
    bytes += contents;
    return add("bufferViews", view);
  }
  template <typename T>
  int view(const std::vector<T>& values, int stride = 0) {
    return view(std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)), stride);
  }
  template <typename T>
  int accessor(const std::string& type, Component component, const std::vector<T>& values, bool normalized = false) {
    nlohmann::json accessor = {{"bufferView", view(values)}, {"componentType", component}, {"type", type}};
    accessor["count"] = values.size() / (type == "SCALAR" ? 1u
                                         : type == "MAT4" ? 16u
                                                          : static_cast<unsigned>(type[3] - '0'));
    if (normalized) accessor["normalized"] = true;
    return add("accessors", accessor);
  }
  int floats(const std::string& type, const std::vector<float>& values) { return accessor(type, kFloat, values); }

  // A mesh of one primitive, in a node of its own; returns the node.
  int mesh_node(nlohmann::json attributes, nlohmann::json more = nlohmann::json::object()) {
    more["attributes"] = std::move(attributes);
    return add("nodes", {{"mesh", add("meshes", {{"primitives", {more}}})}});
  }
  nlohmann::json& primitive(int mesh = 0) { return root["meshes"][static_cast<unsigned>(mesh)]["primitives"][0]; }
  // (0,0,0), (1,0,0), (0,1,0) as accessor 0, mesh 0 and node 0.
  static GltfBuilder triangle() {
    GltfBuilder builder;
    builder.mesh_node({{"POSITION", builder.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0})}});
    return builder;
  }

  // The document with buffer 0 as a data URI, as a file of that name, or (no URI) for the binary chunk.
  std::string json(const std::string& uri = "data:") const {
    nlohmann::json document = root;
    if (!bytes.empty()) {
      nlohmann::json buffer = {{"byteLength", bytes.size()}};
      if (!uri.empty()) buffer["uri"] = uri == "data:" ? "data:application/octet-stream;base64," + base64(bytes) : uri;
      auto& buffers = document["buffers"];
      if (buffers.is_null()) buffers = nlohmann::json::array();
      buffers.insert(buffers.begin(), buffer);
    }
    return document.dump();
  }
  std::string glb() const {
    std::string text = json(""), binary = bytes;
    text.resize((text.size() + 3) / 4 * 4, ' ');
    binary.resize((binary.size() + 3) / 4 * 4);
    return "glTF" + word(2) + word(static_cast<std::uint32_t>(28 + text.size() + binary.size())) +
           word(static_cast<std::uint32_t>(text.size())) + "JSON" + text +
           word(static_cast<std::uint32_t>(binary.size())) + std::string("BIN\0", 4) + binary;
  }

  static std::string word(std::uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), 4); }
  static std::string base64(const std::string& data) {
    static const char* kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::string result;
    for (std::size_t i = 0; i < data.size(); i += 3) {
      std::uint32_t bits = 0;
      for (std::size_t k = 0; k < 3; ++k)
        bits = bits << 8 | (i + k < data.size() ? static_cast<std::uint8_t>(data[i + k]) : 0u);
      for (std::size_t k = 0; k < 4; ++k) result += i + k > data.size() ? '=' : kDigits[bits >> (18 - 6 * k) & 63];
    }
    return result;
  }
};

} // namespace wavepath::test
