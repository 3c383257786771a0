// Layout: magic, then the length of a JSON document and the document, the film's pixels, its AOVs, splats, groups of
// lights and cover, and the hash of all before it. Numbers are as the machine has them (little-endian on everything
// that Vulkan drivers exist for).
#include "host/render/report/state_file.h"

#include <array>
#include <cstring>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/hash.h"
#include "host/base/read_file.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kMagic = "wavepath state 6\n";
constexpr const char* kRemedy = "start again without --resume, or name another --checkpoint";

Json state_json(const Checkpoint& c) {
  return {c.spp,
          c.seconds,
          c.gpu_seconds,
          c.rays.camera,
          c.rays.bounce,
          c.rays.shadow,
          c.error.relative_rms,
          c.error.ci95[0],
          c.error.ci95[1],
          c.error.largest_sample_fraction,
          c.rays.occlusion};
}

// NaN has no place in JSON; it comes back as null.
double number(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

Checkpoint checkpoint_from(const Json& j) {
  Checkpoint c;
  c.spp = j.at(0);
  c.seconds = j.at(1), c.gpu_seconds = j.at(2);
  c.rays = {j.at(3), j.at(4), j.at(5), j.at(10)};
  c.error = {number(j.at(6)), {number(j.at(7)), number(j.at(8))}, number(j.at(9))};
  return c;
}

Json state_json(const Nonfinite& nonfinite) {
  Json first = nullptr;
  if (nonfinite.first)
    first = {nonfinite.first->sample, nonfinite.first->at.pixel, nonfinite.first->at.replicate, nonfinite.first->maker};
  return {{"by_maker", nonfinite.by_maker}, {"first", first}};
}

Nonfinite nonfinite_from(const Json& json) {
  Nonfinite nonfinite;
  nonfinite.by_maker = json.at("by_maker").get<decltype(nonfinite.by_maker)>();
  const Json& first = json.at("first");
  if (!first.is_null()) nonfinite.first = {first.at(0), {first.at(1), first.at(2)}, first.at(3)};
  return nonfinite;
}

Json state_json(const RayCounts& rays) { return {rays.camera, rays.bounce, rays.shadow, rays.occlusion}; }

Json state_json(const PicturePlace& place) { return {place.left, place.top, place.whole_width, place.whole_height}; }
PicturePlace place_from(const Json& json) { return {json.at(0), json.at(1), json.at(2), json.at(3)}; }

Json state_json(const std::optional<NoisePilot>& pilot) {
  return pilot ? Json{pilot->samples, pilot->width, pilot->height, pilot->cost, pilot->used} : Json();
}

std::optional<NoisePilot> noise_from(const Json& json) {
  if (json.is_null()) return std::nullopt;
  return NoisePilot{json.at(0), json.at(1), json.at(2), json.at(3), json.at(4)};
}

Json describe(const std::string& identity, const std::string& device, const std::string& plan,
              const RenderState& state) {
  Json checkpoints = Json::array(), stages = Json::array();
  for (const Checkpoint& c : state.checkpoints) checkpoints.push_back(state_json(c));
  for (const StageTime& s : state.stages) stages.push_back({s.name, s.seconds, s.dispatches});
  const RenderCursor& cursor = state.cursor;
  return {{"identity", identity},
          {"device", device},
          {"plan", plan},
          {"cursor", {cursor.sample, cursor.pass_samples, cursor.segment, cursor.pixels_done}},
          {"first_sample", state.first_sample},
          {"seconds", state.seconds},
          {"estimate_seconds", state.estimate_seconds},
          {"rays", state_json(state.rays)},
          {"nonfinite", state_json(state.nonfinite)},
          {"stages", stages},
          {"checkpoints", checkpoints},
          {"levels", state.levels},
          {"noise", state_json(state.noise)},
          {"next_check", state.next_check},
          {"size", {state.film.width, state.film.height}},
          {"place", state_json(state.film.place)},
          {"aovs", !state.film.aovs.empty()},
          {"splats", !state.film.splats.empty()},
          {"whole_nets", state.film.has_probes},
          {"seed", state.film.seed},
          {"quads", state.film.quads},
          {"groups", state.film.group_count},
          {"cover", !state.film.cover.empty()}};
}

RenderState state_from(const Json& json) {
  RenderState state;
  const Json& cursor = json.at("cursor");
  state.cursor = {cursor.at(0), cursor.at(1), cursor.at(2), cursor.at(3)};
  state.first_sample = json.at("first_sample");
  state.seconds = json.at("seconds");
  state.estimate_seconds = json.at("estimate_seconds");
  const Json& rays = json.at("rays");
  state.rays = {rays.at(0), rays.at(1), rays.at(2), rays.at(3)};
  state.nonfinite = nonfinite_from(json.at("nonfinite"));
  for (const Json& s : json.at("stages")) state.stages.push_back({s.at(0), s.at(1), s.at(2)});
  for (const Json& c : json.at("checkpoints")) state.checkpoints.push_back(checkpoint_from(c));
  state.levels = json.at("levels").get<std::vector<std::int8_t>>();
  state.noise = noise_from(json.value("noise", Json()));
  state.next_check = json.at("next_check");
  return state;
}

// A file read from front to back.
class Reader {
public:
  explicit Reader(const std::string& path) : path_(path), size_(regular_file_size(path).value_or(0)) {
    if (size_ == 0) throw Error(path, "is no state of a render", kRemedy);
  }
  void read(void* data, std::uint64_t bytes) {
    if (bytes > size_ - at_ ||
        !read_file(path_, at_, {static_cast<std::uint8_t*>(data), static_cast<std::size_t>(bytes)}))
      throw Error(path_, "is not complete", kRemedy);
    checksum_.add_bytes(data, bytes);
    at_ += bytes;
  }
  std::uint64_t left() const { return size_ - at_; }
  std::uint64_t checksum() const { return checksum_.value(); }

private:
  std::string path_;
  std::uint64_t size_, at_ = 0;
  Hash checksum_;
};

template <class T>
std::uint64_t byte_count(const std::vector<T>& values) {
  return values.size() * sizeof(T);
}

} // namespace

void write_state(const std::string& path, const std::string& identity, const std::string& device,
                 const std::string& plan, const RenderState& state) {
  const std::string document = describe(identity, device, plan, state).dump();
  AtomicFile file(path);
  Hash checksum;
  const auto write = [&](const void* data, std::size_t bytes) {
    file.write(data, bytes);
    checksum.add_bytes(data, bytes);
  };
  const std::uint64_t length = document.size();
  write(kMagic.data(), kMagic.size());
  write(&length, sizeof(length));
  write(document.data(), document.size());
  write(state.film.pixels.data(), byte_count(state.film.pixels));
  write(state.film.aovs.data(), byte_count(state.film.aovs));
  write(state.film.splats.data(), byte_count(state.film.splats));
  write(state.film.groups.data(), byte_count(state.film.groups));
  write(state.film.group_splats.data(), byte_count(state.film.group_splats));
  write(state.film.cover.data(), byte_count(state.film.cover));
  const std::uint64_t sum = checksum.value();
  file.write(&sum, sizeof(sum));
  file.commit();
}

StateRecord read_state(const std::string& path) try {
  Reader reader(path);
  std::string magic(kMagic.size(), ' ');
  if (reader.left() < magic.size()) throw Error(path, "is no state of a render", kRemedy);
  reader.read(magic.data(), magic.size());
  if (magic != kMagic) throw Error(path, "is no state of a render, or one of another version", kRemedy);
  std::uint64_t length = 0;
  reader.read(&length, sizeof(length));
  if (length > reader.left()) throw Error(path, "is not complete", kRemedy);
  std::string document(length, ' ');
  reader.read(document.data(), length);
  const Json json = Json::parse(document);
  StateRecord record{json.at("identity"), json.at("device"), json.at("plan"), state_from(json)};

  const FilmShape shape{json.at("size").at(0),
                        json.at("size").at(1),
                        json.at("aovs"),
                        json.at("splats"),
                        json.at("whole_nets"),
                        json.at("seed"),
                        json.value("quads", false),
                        json.value("groups", 0u),
                        json.value("cover", false),
                        json.contains("place") ? place_from(json.at("place")) : PicturePlace{}};
  if (reader.left() != shape.bytes() + sizeof(std::uint64_t)) throw Error(path, "is not complete", kRemedy);
  Film& film = record.state.film;
  film = make_film(shape);
  reader.read(film.pixels.data(), byte_count(film.pixels));
  reader.read(film.aovs.data(), byte_count(film.aovs));
  reader.read(film.splats.data(), byte_count(film.splats));
  reader.read(film.groups.data(), byte_count(film.groups));
  reader.read(film.group_splats.data(), byte_count(film.group_splats));
  reader.read(film.cover.data(), byte_count(film.cover));
  count_light_paths(film);
  const std::uint64_t computed = reader.checksum();
  std::uint64_t recorded = 0;
  reader.read(&recorded, sizeof(recorded));
  if (recorded != computed) throw Error(path, "is damaged: its checksum does not fit", kRemedy);
  return record;
} catch (const Error&) {
  throw;
} catch (const std::bad_alloc&) {
  throw;
} catch (const std::exception& error) {
  throw Error(path, fmt::format("is damaged ({})", error.what()), kRemedy);
}

} // namespace wavepath
