#include "host/scene/gltf/foreign.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <string_view>
#include <vector>

#include "host/base/read_file.h"
#include "host/base/shell_quote.h"

namespace wavepath::gltf {
namespace {

enum class Maker : std::uint8_t { assimp, blender, blender_usd, convert };

struct ForeignFormat {
  const char* what;
  Maker maker;
  std::string_view magic;      // its first bytes; empty: only its extension tells
  std::string_view extensions; // ".obj" and so on, each with a blank after it
};

// Magics come first: what a file holds counts more than its name.
constexpr ForeignFormat kForeignFormats[] = {
    {"is a PLY mesh", Maker::assimp, "ply\n", ""},
    {"is a PLY mesh", Maker::assimp, "ply\r", ""},
    {"is an FBX file", Maker::assimp, "Kaydara FBX Binary", ""},
    {"is an FBX file", Maker::assimp, "; FBX", ""},
    {"is a USD file", Maker::blender_usd, "PXR-USDC", ""},
    {"is a USD file", Maker::blender_usd, "#usda", ""},
    {"is a Blender file", Maker::blender, "BLENDER", ""},
    {"is an OBJ mesh", Maker::assimp, "", ".obj "},
    {"is a PLY mesh", Maker::assimp, "", ".ply .gz "},
    {"is an STL mesh", Maker::assimp, "", ".stl "},
    {"is an FBX file", Maker::assimp, "", ".fbx "},
    {"is a Collada file", Maker::assimp, "", ".dae "},
    {"is a 3DS file", Maker::assimp, "", ".3ds "},
    {"is a USD file", Maker::blender_usd, "", ".usd .usda .usdc .usdz "},
    {"is a Blender file", Maker::blender, "", ".blend "},
    {"is a scene of pbrt", Maker::convert, "", ".pbrt "},
};

std::string first_bytes(const std::filesystem::path& path) {
  const std::uint64_t size = std::min<std::uint64_t>(regular_file_size(path).value_or(0), 4096);
  std::vector<std::uint8_t> bytes(size);
  if (!read_file(path, 0, bytes)) return "";
  return {bytes.begin(), bytes.end()};
}

std::string python_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) {
    if (c == '\\' || c == '\'') out += '\\';
    out += c;
  }
  return out + "'";
}

std::string command_of(Maker maker, const std::string& from, const std::string& to) {
  const std::string save = "bpy.ops.export_scene.gltf(filepath=" + python_text(to) + ")";
  switch (maker) {
    case Maker::assimp:
      return "assimp export " + shell_quoted(from) + " " + shell_quoted(to) + " (package assimp-utils)";
    case Maker::blender:
      return "blender --background " + shell_quoted(from) + " --python-expr " + shell_quoted("import bpy; " + save);
    case Maker::blender_usd:
      return "blender --background --python-expr " +
             shell_quoted("import bpy; bpy.ops.wm.usd_import(filepath=" + python_text(from) + "); " + save);
    case Maker::convert:
      break;
  }
  return "wavepath convert " + shell_quoted(from) + " " + shell_quoted(to);
}

} // namespace

std::optional<ForeignFile> foreign_file(const std::filesystem::path& path) {
  const std::string bytes = first_bytes(path), from = path.string();
  if (bytes.starts_with("glTF")) return std::nullopt;
  const std::string to = std::filesystem::path(path).replace_extension(".glb").string();
  const auto found = [&](const char* what, Maker maker) { return ForeignFile{what, command_of(maker, from, to)}; };
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  for (const ForeignFormat& format : kForeignFormats)
    if (!format.magic.empty() && bytes.starts_with(format.magic)) return found(format.what, format.maker);
  const std::size_t first = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  if (first != std::string::npos && bytes[first] == '{') return std::nullopt; // glTF by another name
  if (first != std::string::npos && bytes[first] == '<') {
    if (bytes.find("<COLLADA") != std::string::npos) return found("is a Collada file", Maker::assimp);
    if (bytes.find("<scene") != std::string::npos) return found("is a scene of Mitsuba", Maker::convert);
  }
  for (const ForeignFormat& format : kForeignFormats)
    if (!extension.empty() && format.extensions.find(extension + " ") != std::string_view::npos)
      return found(format.what, format.maker);
  return std::nullopt;
}

} // namespace wavepath::gltf
