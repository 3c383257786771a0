// The XML of Mitsuba scenes: elements, parameters, includes, transforms.
#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>

#include "host/base/error.h"
#include "host/convert/mesh_files.h"
#include "host/convert/mitsuba_reader.h"

namespace wavepath::convert {
namespace {

constexpr std::size_t kMostDocuments = 256;
constexpr int kDeepestXml = 64;

// toWorld and intIOR of the versions before 2 as later ones have them.
std::string snake_case(std::string_view name) {
  std::string out;
  for (std::size_t i = 0; i < name.size(); ++i) {
    const auto c = static_cast<unsigned char>(name[i]);
    const bool starts_word =
        std::isupper(c) && i > 0 && !std::isupper(static_cast<unsigned char>(name[i - 1])) && name[i - 1] != '_';
    if (starts_word) out += '_';
    out += static_cast<char>(std::tolower(c));
  }
  return out;
}

void check_depth(const MitsubaReader& reader, const pugi::xml_node& node, int depth) {
  if (depth > kDeepestXml) fail_at(reader, node, "nests elements too deep");
  for (const pugi::xml_node& child : node.children()) check_depth(reader, child, depth + 1);
}

pugi::xml_node load(MitsubaReader& reader, const std::string& path) {
  if (reader.documents.size() >= kMostDocuments)
    throw Error(path, "is one of too many files that include each other", "correct them");
  auto document = std::make_unique<MitsubaDocument>();
  document->path = path;
  document->text = read_bytes(path);
  const pugi::xml_parse_result result = document->xml.load_buffer(document->text.data(), document->text.size());
  if (!result) {
    const auto end = document->text.begin() +
                     std::min<std::ptrdiff_t>(result.offset, static_cast<std::ptrdiff_t>(document->text.size()));
    throw Error(path,
                fmt::format("line {}: is no valid XML ({})", 1 + std::count(document->text.begin(), end, '\n'),
                            result.description()),
                "correct the file");
  }
  const pugi::xml_node root = document->xml.document_element();
  reader.documents.push_back(std::move(document));
  check_depth(reader, root, 0);
  return root;
}

std::string_view tag_of(const pugi::xml_node& node) { return node.name(); }

void collect_ids(MitsubaReader& reader, const pugi::xml_node& node) {
  if (tag_of(node) == "ref") return; // its id is that of what it means
  if (const std::string id = attribute(reader, node, "id"); !id.empty()) reader.ids[id] = node;
  for (const pugi::xml_node& child : node.children()) collect_ids(reader, child);
}

void add_elements(MitsubaReader& reader, const pugi::xml_node& root, std::vector<pugi::xml_node>& out, int depth) {
  if (depth > 16) fail_at(reader, root, "includes files too deep");
  for (const pugi::xml_node& node : root.children()) {
    if (node.type() != pugi::node_element) continue;
    if (tag_of(node) == "default") {
      reader.parameters.emplace(node.attribute("name").value(), attribute(reader, node, "value"));
    } else if (tag_of(node) == "path") {
      reader.folders.push_back(reader.folders.front() / attribute(reader, node, "value"));
    } else if (tag_of(node) == "include") {
      add_elements(reader, load(reader, read_path(reader, node, attribute(reader, node, "filename"))), out, depth + 1);
    } else if (tag_of(node) == "alias") {
      const auto found = reader.ids.find(attribute(reader, node, "id"));
      if (found != reader.ids.end()) reader.ids[attribute(reader, node, "as")] = found->second;
    } else {
      collect_ids(reader, node);
      out.push_back(node);
    }
  }
}

double number_attribute(const MitsubaReader& reader, const pugi::xml_node& node, const char* name, double otherwise) {
  const std::string text = attribute(reader, node, name);
  if (text.empty()) return otherwise;
  const std::vector<double> numbers = numbers_of(reader, node, text);
  return numbers.empty() ? otherwise : numbers[0];
}

// "value" of one number or three, or x, y and z.
glm::dvec3 vector_of(const MitsubaReader& reader, const pugi::xml_node& node, double otherwise) {
  const std::vector<double> numbers = numbers_of(reader, node, attribute(reader, node, "value"));
  if (numbers.size() >= 3) return {numbers[0], numbers[1], numbers[2]};
  if (numbers.size() == 1) return glm::dvec3(numbers[0]);
  return {number_attribute(reader, node, "x", otherwise), number_attribute(reader, node, "y", otherwise),
          number_attribute(reader, node, "z", otherwise)};
}

glm::dvec3 triple_attribute(const MitsubaReader& reader, const pugi::xml_node& node, const char* name,
                            const glm::dvec3& otherwise) {
  const std::string text = attribute(reader, node, name);
  if (text.empty()) return otherwise;
  const std::vector<double> numbers = numbers_of(reader, node, text);
  if (numbers.size() != 3) fail_at(reader, node, fmt::format("'{}' has no three numbers", name));
  return {numbers[0], numbers[1], numbers[2]};
}

glm::dmat4 look_at_of(const MitsubaReader& reader, const pugi::xml_node& node) {
  const glm::dvec3 origin = triple_attribute(reader, node, "origin", glm::dvec3(0.0));
  const glm::dvec3 target = triple_attribute(reader, node, "target", glm::dvec3(0.0, 0.0, 1.0));
  const glm::dvec3 ahead = glm::normalize(target - origin);
  glm::dvec3 up = triple_attribute(reader, node, "up", glm::dvec3(0.0));
  if (glm::length(up) == 0.0) up = std::abs(ahead.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(0, 0, 1);
  const glm::dvec3 left = glm::normalize(glm::cross(up, ahead));
  glm::dmat4 matrix(1.0);
  matrix[0] = glm::dvec4(left, 0.0), matrix[1] = glm::dvec4(glm::cross(ahead, left), 0.0);
  matrix[2] = glm::dvec4(ahead, 0.0), matrix[3] = glm::dvec4(origin, 1.0);
  if (!(std::abs(glm::determinant(matrix)) > 0.5)) fail_at(reader, node, "lookat has no direction");
  return matrix;
}

glm::dmat4 matrix_of(const MitsubaReader& reader, const pugi::xml_node& node) {
  const std::vector<double> numbers = numbers_of(reader, node, attribute(reader, node, "value"));
  const std::size_t side = numbers.size() == 9 ? 3 : 4;
  if (numbers.size() != side * side) fail_at(reader, node, "a matrix has neither 16 numbers nor 9");
  glm::dmat4 matrix(1.0);
  for (std::size_t r = 0; r < side; ++r)
    for (std::size_t c = 0; c < side; ++c) matrix[static_cast<int>(c)][static_cast<int>(r)] = numbers[r * side + c];
  return matrix;
}

glm::dmat4 rotation_of(const MitsubaReader& reader, const pugi::xml_node& node) {
  const glm::dvec3 axis = vector_of(reader, node, 0.0);
  if (!(glm::length(axis) > 0.0)) fail_at(reader, node, "a rotation has no axis");
  const double degrees = number_attribute(reader, node, "angle", 0.0);
  return glm::rotate(glm::dmat4(1.0), glm::radians(degrees), glm::normalize(axis));
}

glm::dmat4 steps_of(MitsubaReader& reader, const pugi::xml_node& node) {
  glm::dmat4 matrix(1.0);
  for (const pugi::xml_node& step : node.children()) {
    const std::string tag = snake_case(tag_of(step));
    if (tag == "translate")
      matrix = glm::translate(glm::dmat4(1.0), vector_of(reader, step, 0.0)) * matrix;
    else if (tag == "scale")
      matrix = glm::scale(glm::dmat4(1.0), vector_of(reader, step, 1.0)) * matrix;
    else if (tag == "rotate")
      matrix = rotation_of(reader, step) * matrix;
    else if (tag == "matrix")
      matrix = matrix_of(reader, step) * matrix;
    else if (tag == "lookat" || tag == "look_at")
      matrix = look_at_of(reader, step) * matrix;
    else if (step.type() == pugi::node_element)
      fail_at(reader, step, fmt::format("'{}' is no transform", tag.substr(0, 40)));
  }
  return matrix;
}

} // namespace

void fail_at(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& problem,
             const std::string& remedy) {
  for (const std::unique_ptr<MitsubaDocument>& document : reader.documents)
    if (document->xml == node.root()) {
      const auto offset =
          std::clamp<std::ptrdiff_t>(node.offset_debug(), 0, static_cast<std::ptrdiff_t>(document->text.size()));
      const auto line = 1 + std::count(document->text.begin(), document->text.begin() + offset, '\n');
      throw Error(document->path, fmt::format("line {}: {}", line, problem), remedy);
    }
  throw Error(reader.documents.front()->path, problem, remedy);
}

std::vector<pugi::xml_node> read_elements(MitsubaReader& reader, const std::string& path) {
  reader.folders.push_back(std::filesystem::path(path).parent_path());
  const pugi::xml_node root = load(reader, path);
  if (tag_of(root) != "scene") throw Error(path, "is no scene of Mitsuba", "give a scene of Mitsuba 3");
  std::vector<pugi::xml_node> elements;
  add_elements(reader, root, elements, 0);
  return elements;
}

std::string attribute(const MitsubaReader& reader, const pugi::xml_node& node, const char* name) {
  std::string text = node.attribute(name).value();
  for (std::size_t at = text.find('$'); at != std::string::npos; at = text.find('$', at)) {
    std::size_t end = at + 1;
    while (end < text.size() && (std::isalnum(static_cast<unsigned char>(text[end])) || text[end] == '_')) ++end;
    const auto found = reader.parameters.find(text.substr(at + 1, end - at - 1));
    if (found == reader.parameters.end())
      fail_at(reader, node,
              fmt::format("parameter '{}' has no value", text.substr(at, std::min<std::size_t>(end - at, 40))),
              "add a <default> for it");
    if (text.size() + found->second.size() > 65536) fail_at(reader, node, "has a value that grows without end");
    text.replace(at, end - at, found->second);
    at += found->second.size(); // values are not replaced again
  }
  return text;
}

pugi::xml_node resolved(const MitsubaReader& reader, const pugi::xml_node& node) {
  if (tag_of(node) != "ref") return node;
  const auto found = reader.ids.find(attribute(reader, node, "id"));
  if (found == reader.ids.end())
    fail_at(reader, node, fmt::format("'{}' is not there", attribute(reader, node, "id").substr(0, 80)));
  return found->second;
}

pugi::xml_node named_child(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name) {
  reader.asked[node.hash_value()].emplace(name);
  for (const pugi::xml_node& child : node.children())
    if (snake_case(child.attribute("name").value()) == name) return resolved(reader, child);
  return {};
}

void tell_unused(MitsubaReader& reader, const pugi::xml_node& node) {
  // How a light is picked changes no picture.
  static constexpr std::string_view kPassedOver[] = {"sampling_weight"};
  static constexpr std::string_view kValues[] = {"float",    "integer", "boolean",   "string", "rgb",
                                                 "spectrum", "color",   "blackbody", "vector", "transform",
                                                 "texture",  "volume",  "point"};
  auto& asked = reader.asked[node.hash_value()];
  for (const pugi::xml_node& child : node.children()) {
    const std::string name = snake_case(child.attribute("name").value());
    if (name.empty() || asked.contains(name) || std::ranges::find(kPassedOver, name) != std::end(kPassedOver)) continue;
    if (std::ranges::find(kValues, tag_of(resolved(reader, child))) == std::end(kValues)) continue;
    reader.scene.losses.add(
        fmt::format("parameter '{}' of {} '{}' ignored", name, tag_of(node), attribute(reader, node, "type")));
    asked.insert(name);
  }
}

std::vector<pugi::xml_node> children_of(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view tag) {
  std::vector<pugi::xml_node> out;
  for (const pugi::xml_node& child : node.children()) {
    if (child.type() != pugi::node_element) continue;
    const pugi::xml_node meant = resolved(reader, child);
    if (tag_of(meant) == tag) out.push_back(meant);
  }
  return out;
}

std::vector<double> numbers_of(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& text) {
  std::vector<double> out;
  const char *at = text.data(), *end = text.data() + text.size();
  while (at < end) {
    if (std::isspace(static_cast<unsigned char>(*at)) || *at == ',' || *at == ':' || *at == '+') {
      ++at;
      continue;
    }
    double value = 0.0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc() || !std::isfinite(value))
      fail_at(reader, node, fmt::format("'{}' has something that is no number", text.substr(0, 60)));
    out.push_back(value);
    at = stop;
  }
  return out;
}

double read_float(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, double otherwise) {
  const pugi::xml_node child = named_child(reader, node, name);
  return child ? number_attribute(reader, child, "value", otherwise) : otherwise;
}

bool read_bool(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name, bool otherwise) {
  const std::string text = read_text(reader, node, name, "");
  return text.empty() ? otherwise : text == "true" || text == "True" || text == "1";
}

std::string read_text(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name,
                      const std::string& otherwise) {
  const pugi::xml_node child = named_child(reader, node, name);
  return child && child.attribute("value") ? attribute(reader, child, "value") : otherwise;
}

std::string read_path(const MitsubaReader& reader, const pugi::xml_node& node, const std::string& name) {
  if (name.empty()) fail_at(reader, node, "names no file");
  for (const std::filesystem::path& folder : reader.folders) {
    const std::filesystem::path path = folder / name; // an absolute name stays as it is
    std::error_code error;
    if (std::filesystem::exists(path, error)) return path.string();
  }
  return (reader.folders.front() / name).string();
}

glm::dvec3 read_vector(const MitsubaReader& reader, const pugi::xml_node& node, std::string_view name,
                       const glm::dvec3& otherwise) {
  const pugi::xml_node child = named_child(reader, node, name);
  return child ? vector_of(reader, child, 0.0) : otherwise;
}

glm::dmat4 read_transform(MitsubaReader& reader, const pugi::xml_node& node, std::string_view name) {
  const pugi::xml_node child = named_child(reader, node, name);
  if (!child) return glm::dmat4(1.0);
  if (tag_of(child) == "transform") return steps_of(reader, child);
  reader.scene.losses.add("motion of a transform: its first one instead");
  const pugi::xml_node first = child.child("transform");
  return first ? steps_of(reader, first) : glm::dmat4(1.0);
}

} // namespace wavepath::convert
