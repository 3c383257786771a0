// wavepath merge: joins renders of disjoint sample ranges, or of parts of a picture (--crop), into the picture that one
// render of all of them gives.
#include <algorithm>
#include <filesystem>
#include <memory>

#include <fmt/format.h>

#include "host/base/atomic_file.h"
#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/render_flags.h"
#include "host/cli/report.h"
#include "host/film/error.h"
#include "host/film/film.h"
#include "host/film/group_layers.h"
#include "host/passes/passes.h"
#include "host/picture/files/picture_io.h"
#include "host/picture/place.h"
#include "host/render/denoised.h"
#include "host/render/settings/identity.h"
#include "host/session/judge.h"

namespace wavepath {
namespace {

struct MergeCommandRequest {
  std::vector<std::string> parts;
  OutputRequest output;
};

struct Range {
  std::uint32_t first = 0, end = 0; // samples first <= s < end
  std::string part;
};

// Of the attribute wavepath.samples: "A:B", or several of them separated by commas.
std::vector<Range> read_ranges(const std::string& path) {
  std::vector<Range> ranges;
  const std::string text = read_attribute(path, "wavepath.samples");
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = std::min(text.find(',', at), text.size());
    Range range{0, 0, path};
    if (std::sscanf(text.substr(at, end - at).c_str(), "%u:%u", &range.first, &range.end) != 2 ||
        range.first > range.end)
      throw Error(path, "has no readable range of samples", "render it again");
    ranges.push_back(range);
    at = end + 1;
  }
  return ranges;
}

void refuse_overlaps(std::vector<Range>& ranges) {
  std::sort(ranges.begin(), ranges.end(), [](const Range& a, const Range& b) { return a.first < b.first; });
  for (std::size_t i = 1; i < ranges.size(); ++i)
    if (ranges[i].first < ranges[i - 1].end)
      throw Error(ranges[i].part,
                  fmt::format("holds samples {}:{}, of which {} has some as well ({}:{})", ranges[i].first,
                              ranges[i].end, ranges[i - 1].part, ranges[i - 1].first, ranges[i - 1].end),
                  "give parts whose --samples do not overlap");
}

std::string join_ranges(const std::vector<Range>& ranges) {
  std::vector<Range> joined;
  for (const Range& range : ranges)
    if (!joined.empty() && joined.back().end == range.first)
      joined.back().end = range.end;
    else
      joined.push_back(range);
  std::string text;
  for (const Range& range : joined) text += fmt::format("{}{}:{}", text.empty() ? "" : ",", range.first, range.end);
  return text;
}

// What the header of a part says about it besides its sums.
std::string read_identity(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) throw Error(path, "does not exist", "check the name");
  if (picture_format(path) != PictureFormat::exr)
    throw UsageError(path, "is no .exr", "merge the .exr files of renders");
  const std::string identity = read_attribute(path, "wavepath.identity");
  if (identity.empty()) {
    read_picture(path); // says what is wrong if it is no picture at all
    throw Error(path, "holds no exact sums", "render it with --samples or --mergeable, to its end");
  }
  return identity;
}

// Channels that the parts have besides R G B A, as names of --aov.
std::vector<std::string> aovs_of(const Picture& picture) {
  const std::pair<const char*, const char*> names[] = {{"albedo", "albedo.R"},
                                                       {"normal", "N.X"},
                                                       {"depth", "Z"},
                                                       {"position", "P.X"},
                                                       {"variance", "variance.R"},
                                                       {"samples", "samples"},
                                                       {"direct", "direct.R"},
                                                       {"indirect", "indirect.R"},
                                                       {"emission", "emission.R"},
                                                       {"roughness", "roughness"},
                                                       {"metallic", "metallic"},
                                                       {"ids", "id.triangle"},
                                                       {"shadow", "shadow"},
                                                       {"environment", "environment.R"}};
  std::vector<std::string> aovs;
  for (const auto& [name, channel] : names)
    if (find_channel(picture, channel)) aovs.emplace_back(name);
  return aovs;
}

// What the positions in a part are relative to.
glm::dvec3 read_origin(const std::string& path) {
  const std::optional<glm::dvec3> origin = read_vector(path, "wavepath.origin");
  if (!origin) throw Error(path, "lacks the attribute wavepath.origin", "render it again");
  return *origin;
}

void check_outputs(const MergeCommandRequest& request) {
  const std::vector<std::string>& pictures = request.output.pictures;
  for (const std::string& path : pictures) require_format(path, 1, 1);
  check_write_options(request.output);
  refuse_overwriting(pictures, request.parts);
  for (const std::string& path : pictures) require_writable(path);
}

// Parts of the same pixels (--crop), whose samples are joined.
struct Region {
  PartWindow window;
  std::vector<std::string> parts;
  std::vector<Range> ranges;
  std::shared_ptr<Film> film;
};

// All parts must have the given identity; those of one region have no sample in common.
std::vector<Region> read_regions(const std::vector<std::string>& parts, const std::string& identity) {
  std::vector<Region> regions;
  for (const std::string& path : parts) {
    if (const auto difference = first_difference(read_identity(path), identity))
      throw Error(path, fmt::format("does not belong to {}: {}", parts.front(), *difference), "render all parts alike");
    const std::optional<PartWindow> window = read_window(path);
    if (!window) throw Error(path, "has a data window that no render has", "render it again");
    auto region = std::ranges::find(regions, *window, &Region::window);
    if (region == regions.end()) region = regions.insert(regions.end(), Region{*window, {}, {}, nullptr});
    region->parts.push_back(path);
    for (const Range& range : read_ranges(path)) region->ranges.push_back(range);
  }
  for (Region& region : regions) {
    refuse_overlaps(region.ranges);
    const Region& first = regions.front();
    if (join_ranges(region.ranges) != join_ranges(first.ranges))
      throw Error(region.parts.front(),
                  fmt::format("and others of its pixels hold samples {}, {} has {}", join_ranges(region.ranges),
                              first.parts.front(), join_ranges(first.ranges)),
                  "give all pixels the same samples");
  }
  return regions;
}

// The sums of the parts of a region. Sets origin and device of `info`, and adds seconds.
std::shared_ptr<Film> join_films(const std::vector<std::string>& parts, PictureInfo& info, Warnings& warnings) {
  std::shared_ptr<Film> film;
  for (const std::string& path : parts) {
    const std::shared_ptr<const Film> part = read_film(path);
    if (!part) throw Error(path, "holds no exact sums", "render it with --samples or --mergeable, to its end");
    const glm::dvec3 origin = read_origin(path);
    if (film && film->shape() != part->shape())
      throw Error(path, fmt::format("holds sums of another kind than {}", parts.front()), "render all parts alike");
    if (film)
      join(*film, *part);
    else
      film = std::make_shared<Film>(*part);
    const std::string device = read_attribute(path, "wavepath.device");
    if (info.device.empty()) info.origin = origin, info.device = device;
    if (origin != info.origin)
      throw Error(path, fmt::format("has another origin than {}", parts.front()), "render all parts alike");
    info.seconds += read_number(path, "wavepath.seconds").value_or(0.0);
    if (info.device != device)
      warnings.add(fmt::format(
          "{}: rendered on {}, others on {}; the result is as good, but not bit by bit what one device gives", path,
          device, info.device));
  }
  return film;
}

// The smallest rectangle that holds all regions.
gpu::FilmArea area_around(const std::vector<Region>& regions) {
  gpu::FilmArea all = regions.front().film->shape().area();
  for (const Region& region : regions) {
    const gpu::FilmArea area = region.film->shape().area();
    const std::uint32_t right = std::max(all.left + all.width, area.left + area.width),
                        bottom = std::max(all.top + all.height, area.top + area.height);
    all.left = std::min(all.left, area.left), all.top = std::min(all.top, area.top);
    all.width = right - all.left, all.height = bottom - all.top;
  }
  return all;
}

// The film of all regions, which must fill a rectangle.
std::shared_ptr<Film> join_regions(const std::vector<Region>& regions) {
  if (regions.size() == 1) return regions.front().film;
  const gpu::FilmArea all = area_around(regions);
  FilmShape shape = regions.front().film->shape();
  const auto kind = [](FilmShape of) {
    of.width = of.height = 0, of.place = {};
    return of;
  };
  const FilmShape common = kind(shape);
  shape.width = all.width, shape.height = all.height;
  const bool is_whole = all.width == all.whole_width && all.height == all.whole_height;
  shape.place = is_whole ? PicturePlace{} : PicturePlace{all.left, all.top, all.whole_width, all.whole_height};
  require_memory("merge", "joining parts", shape.bytes(), "merge fewer parts");
  const auto film = std::make_shared<Film>(make_film(shape));
  std::vector<bool> known(shape.pixels());
  for (const Region& region : regions) {
    const std::string& path = region.parts.front();
    if (kind(region.film->shape()) != common)
      throw Error(path, fmt::format("holds sums of another kind than {}", regions.front().parts.front()),
                  "render all parts alike");
    if (!paste(*film, *region.film, known))
      throw Error(path, "has other values than another part where they overlap", "render both on one device");
  }
  const auto gap = std::ranges::find(known, false) - known.begin();
  if (gap < static_cast<std::ptrdiff_t>(known.size()))
    throw Error("merge",
                fmt::format("the parts do not fill a rectangle: pixel {},{} is in none", gap % all.width + all.left,
                            gap / all.width + all.top),
                "add the part that holds it");
  return film;
}

// What all parts have in common is read from one.
void read_common(const std::string& part, PictureInfo& info) {
  info.seed = static_cast<std::uint32_t>(read_number(part, "wavepath.seed").value_or(0.0));
  info.scene = read_attribute(part, "wavepath.scene");
  info.command = read_attribute(part, "wavepath.command");
  info.filter = read_attribute(part, "wavepath.filter");
  info.bias = read_attribute(part, "wavepath.bias");
  info.plan = read_attribute(part, "wavepath.plan");
  info.world_to_camera = read_matrix(part, "worldToCamera");
  info.world_to_ndc = read_matrix(part, "worldToNDC");
  info.focus = read_number(part, "focus");
  info.frame = read_frame(part);
  info.exposure_seconds = read_number(part, "expTime");
}

// Passes of the parts; all have those of the first, or the picture lacks them.
void add_passes_of(const std::vector<Region>& regions, const Picture& first, Picture& picture) {
  if (!has_passes(first)) return;
  for (const Region& region : regions) {
    JoinedPasses joined;
    for (const std::string& part : region.parts) {
      std::uint32_t samples = 0;
      for (const Range& range : read_ranges(part)) samples += range.end - range.first;
      join_passes(joined, read_picture(part), samples);
    }
    Picture passes{region.window.width, region.window.height, {}};
    passes.place = region.window.place;
    add_passes(joined, passes);
    paste(passes, picture);
  }
  const std::string& part = regions.front().parts.front();
  for (const std::string& name : pass_texts())
    if (const std::string text = read_attribute(part, name); !text.empty()) picture.texts.emplace_back(name, text);
}

void print_merged(const MergeCommandRequest& request, const Picture& picture, const PictureInfo& info,
                  const ErrorEstimate& error) {
  print_err("wavepath: {}: samples {} of {} parts{}\n", written_text(request.output, picture), info.samples,
            request.parts.size(),
            info.error ? fmt::format(", estimated error {:.3g} % ({:.3g} to {:.3g})", 100.0 * *info.error,
                                     100.0 * error.ci95[0], 100.0 * error.ci95[1])
                       : "");
}

int run_merge(MergeCommandRequest& request) {
  if (request.parts.size() < 2) throw UsageError("merge", "takes two parts or more", "name the .exr files to join");
  check_outputs(request);
  const std::string& first = request.parts.front();
  PictureInfo info;
  info.identity = read_identity(first);
  std::vector<Region> regions = read_regions(request.parts, info.identity);
  const std::vector<Range> ranges = regions.front().ranges;

  Warnings warnings;
  for (Region& region : regions) region.film = join_films(region.parts, info, warnings);
  const std::shared_ptr<Film> film = join_regions(regions);
  for (const std::string& path : request.output.pictures) require_format(path, film->width, film->height);
  const Picture part = read_picture(first);
  Picture picture = develop(*film, aovs_of(part), info.origin, group_names_of(read_attribute(first, kGroupsText)));
  if (find_channel(part, std::string(kShownPrefix) + "R") && !film->aovs.empty())
    add_denoised(picture, *film, kDenoiseOn); // filtered pictures do not add up: the sums are filtered anew
  add_passes_of(regions, part, picture);
  const ErrorEstimate error = estimate_error(*film);
  for (const Range& range : ranges) info.spp += range.end - range.first;
  if (has_estimate(info.spp, error)) info.error = error.relative_rms;
  info.samples = join_ranges(ranges);
  info.film = film;
  read_common(first, info);
  info.bias = with_clamp_share(info.bias, *film); // that of the part counts its own samples

  Attempts attempts;
  write_pictures(request.output, info, picture, warnings, attempts);
  print_warnings(warnings);
  if (!request.output.quiet) print_merged(request, picture, info, error);
  attempts.finish();
  return kExitDone;
}

} // namespace

Command add_merge(CLI::App& app) {
  CLI::App* command =
      add_command(app, "merge", "join the parts of a split render into one picture",
                  "Make the parts with 'wavepath render --samples A:B', each with the --spp of the whole, or with "
                  "'--crop X,Y,W,H --mergeable'. Parts of one "
                  "device join to the bits of one render with --mergeable, in any order. AOVs of first hits (albedo, "
                  "normal, depth, position, emission, direct) join to within rounding.");
  const auto request = std::make_shared<MergeCommandRequest>();
  require(add_flag(
      *command, "Pictures", {"PARTS", "FILE.exr", "parts of a render, two or more"},
      [=](const FlagValue& value) { request->parts.push_back(value.text); }, true));
  add_picture_output_flags(*command, request->output, "none: name at least one", false);
  add_switch(*command, "Output", {"-q,--quiet", "", "print no summary", "off"}, request->output.quiet);
  return [request] {
    if (request->output.pictures.empty()) throw UsageError("-o", "is missing", "say where the result goes: -o OUT.exr");
    return run_merge(*request);
  };
}

} // namespace wavepath
