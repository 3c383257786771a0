// Interpolates key frames (glTF 2.0 specification, appendix C).
#include "host/scene/gltf/pose.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <nlohmann/json.hpp>

#include "host/scene/gltf/accessor.h"
#include "host/scene/gltf/nodes.h"
#include "host/scene/gltf/pointer.h"
#include "host/scene/gltf/uri.h"

namespace wavepath::gltf {
namespace {

using Values = std::vector<double>;

using nlohmann::json;

constexpr const char* kMovesNothing = "animation channel that moves nothing known ignored";

std::size_t choose_animation(const Document& document, const std::string& request) {
  std::vector<std::string> names;
  for (const auto& animation : document.model.animations) names.push_back(animation.name);
  return choose(document, "animation", names, request);
}

struct Track {
  Values times,
      values; // values: width for each key; three times that for cubic splines: in-tangent, value, out-tangent
  std::size_t width = 0;
  bool step = false, cubic = false;

  Values key(std::size_t index, std::size_t part = 1) const {
    const std::size_t first = (cubic ? index * 3 + part : index) * width;
    return {values.begin() + static_cast<std::ptrdiff_t>(first),
            values.begin() + static_cast<std::ptrdiff_t>(first + width)};
  }
};

Values slerp(const Values& a, Values b, double t) {
  double cosine = 0.0;
  for (std::size_t i = 0; i < 4; ++i) cosine += a[i] * b[i];
  if (cosine < 0.0) { // the shorter way round
    for (double& value : b) value = -value;
    cosine = -cosine;
  }
  const double angle = std::acos(std::min(cosine, 1.0)), sine = std::sin(angle);
  // Next to each other the formula is 0/0 and the straight line is exact to rounding.
  const double wa = sine < 1e-9 ? 1.0 - t : std::sin((1.0 - t) * angle) / sine;
  const double wb = sine < 1e-9 ? t : std::sin(t * angle) / sine;
  Values result(4);
  for (std::size_t i = 0; i < 4; ++i) result[i] = wa * a[i] + wb * b[i];
  return result;
}

Values hermite(const Track& track, std::size_t i, double t, double duration) {
  const Values v0 = track.key(i, 1), m0 = track.key(i, 2), v1 = track.key(i + 1, 1), m1 = track.key(i + 1, 0);
  const double t2 = t * t, t3 = t2 * t;
  Values result(track.width);
  for (std::size_t c = 0; c < track.width; ++c) {
    result[c] = (2.0 * t3 - 3.0 * t2 + 1.0) * v0[c] + duration * (t3 - 2.0 * t2 + t) * m0[c] +
                (3.0 * t2 - 2.0 * t3) * v1[c] + duration * (t3 - t2) * m1[c];
  }
  return result;
}

Values sample(const Track& track, double seconds, bool rotation) {
  const auto after = std::upper_bound(track.times.begin(), track.times.end(), seconds);
  if (after == track.times.begin()) return track.key(0);
  const auto i = static_cast<std::size_t>(after - track.times.begin()) - 1;
  if (after == track.times.end() || track.step) return track.key(i);
  const double duration = track.times[i + 1] - track.times[i];
  const double t = (seconds - track.times[i]) / duration;
  if (track.cubic) return hermite(track, i, t, duration);
  if (rotation) return slerp(track.key(i), track.key(i + 1), t);
  Values a = track.key(i);
  const Values b = track.key(i + 1);
  for (std::size_t c = 0; c < a.size(); ++c) a[c] += t * (b[c] - a[c]);
  return a;
}

Track open_track(Document& document, const tinygltf::AnimationSampler& sampler, const std::string& what,
                 std::size_t width) {
  Track track;
  track.step = sampler.interpolation == "STEP";
  track.cubic = sampler.interpolation == "CUBICSPLINE";
  if (!track.step && !track.cubic && sampler.interpolation != "LINEAR") {
    document.fail(what + " has unknown interpolation '" + shown(sampler.interpolation) + "'");
  }
  const Elements times = open_accessor(document, sampler.input, "times of " + what);
  if (times.components != 1 || times.count == 0) document.fail(what + " has no key frames");
  track.times = all_components(times);
  track.values = all_components(open_accessor(document, sampler.output, "values of " + what));
  track.width = width;
  for (const auto* numbers : {&track.times, &track.values}) {
    if (!std::all_of(numbers->begin(), numbers->end(), [](double x) { return std::isfinite(x); })) {
      document.fail(what + " holds numbers that are not finite");
    }
  }
  if (std::adjacent_find(track.times.begin(), track.times.end(), std::greater_equal<double>()) != track.times.end()) {
    document.fail(what + " has times that do not increase");
  }
  if (track.values.size() != track.times.size() * width * (track.cubic ? 3 : 1)) {
    document.fail(what + " has " + std::to_string(track.values.size()) + " values, which does not fit its " +
                  std::to_string(track.times.size()) + " times");
  }
  return track;
}

// A channel of an animation, opened.
struct Channel {
  Track track;
  bool is_rotation = false;
};

Channel open_channel(Document& document, const tinygltf::Animation& animation, int sampler, const std::string& what,
                     std::size_t width, bool is_rotation) {
  if (static_cast<std::size_t>(sampler) >= animation.samplers.size()) document.fail(what + " has no sampler");
  return {open_track(document, animation.samplers[static_cast<std::size_t>(sampler)], what, width), is_rotation};
}

Values sample(const Channel& channel, double seconds) { return sample(channel.track, seconds, channel.is_rotation); }

// What stays as the shutter opens, of the parts that a pointer moves.
const char* part_name(PointerKind kind) {
  switch (kind) {
    case PointerKind::visibility:
      return "visibility of nodes";
    case PointerKind::material:
      return "materials";
    case PointerKind::light:
      return "lights";
    default:
      return "cameras";
  }
}

// The moments of a pose, and the JSON of the materials that it changes.
struct Moment {
  double seconds = 0.0;
  std::optional<double> close; // of the shutter
  bool is_closing = false;
  json* materials = nullptr;
};

void apply_pointer(Document& document, Warnings& warnings, const tinygltf::Animation& animation,
                   const PointerChannel& source, const std::string& what, const Moment& moment) {
  const std::optional<PointerTarget> target = find_target(document, *moment.materials, source.pointer);
  if (!target) {
    warnings.add("animation of " + pointer_template(source.pointer) + " ignored: wavepath knows no such property");
    return;
  }
  if (target->kind == PointerKind::nothing || (moment.is_closing && target->kind != PointerKind::node)) return;
  const Channel channel = open_channel(document, animation, source.sampler, what, target->width, target->is_rotation);
  if (target->is_boolean && !channel.track.step) document.fail(what + " interpolates between true and false");
  const Values value = sample(channel, moment.seconds);
  if (moment.close && target->kind != PointerKind::node && sample(channel, *moment.close) != value)
    warnings.add(std::string("animated ") + part_name(target->kind) +
                 " that change while the shutter is open stay as it opens");
  target->set(value);
}

bool moves_materials(const std::vector<PointerChannel>& channels) {
  return std::ranges::any_of(channels, [](const PointerChannel& c) { return c.pointer.starts_with("/materials/"); });
}

void apply_node(Document& document, Warnings& warnings, const tinygltf::Animation& animation,
                const tinygltf::AnimationChannel& source, const std::string& what, double seconds) {
  const auto index = static_cast<std::size_t>(source.target_node);
  tinygltf::Node& node = document.model.nodes[index];
  const std::string& path = source.target_path;
  Values* target = path == "translation" ? &node.translation
                   : path == "rotation"  ? &node.rotation
                   : path == "scale"     ? &node.scale
                   : path == "weights"   ? &node.weights
                                         : nullptr;
  const std::size_t width = path == "rotation" ? 4 : path == "weights" ? target_count(document, node) : 3;
  if (!target || width == 0) {
    warnings.add(kMovesNothing);
    return;
  }
  if (target != &node.weights && !node.matrix.empty() && !document.told_matrices.contains(index))
    document.fail(what + " moves a node that has a matrix");
  *target = sample(open_channel(document, animation, source.sampler, what, width, path == "rotation"), seconds);
}

} // namespace

bool animates_materials(const Document& document, const std::string& request) {
  return !request.empty() && moves_materials(document.pointer_channels[choose_animation(document, request)]);
}

void pose(Document& document, Warnings& warnings, const std::string& request, double seconds, Shutter shutter) {
  const std::size_t chosen = choose_animation(document, request);
  const tinygltf::Animation& animation = document.model.animations[chosen];
  const auto name_of = [&](std::size_t channel) {
    return "channel " + std::to_string(channel) + " of animation " + std::to_string(chosen);
  };
  // Extensions may say what else these move.
  if (const std::size_t count = document.nodeless_channels[chosen]) warnings.add(kMovesNothing, count);
  for (std::size_t i = 0; i < animation.channels.size(); ++i)
    apply_node(document, warnings, animation, animation.channels[i], name_of(i), seconds);
  const std::vector<PointerChannel>& pointers = document.pointer_channels[chosen];
  if (pointers.empty()) return;
  const bool others = !shutter.is_closing && moves_materials(pointers);
  json materials = others ? *document.file_materials : *document.materials;
  for (const PointerChannel& channel : pointers)
    apply_pointer(document, warnings, animation, channel, name_of(channel.channel),
                  {seconds, shutter.close, shutter.is_closing, &materials});
  if (others) document.materials = std::make_shared<const json>(std::move(materials));
}

} // namespace wavepath::gltf
