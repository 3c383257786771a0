#include "host/bench/bench_report.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/memory.h"
#include "host/render/report/stats.h"

namespace wavepath {
namespace {

using Json = nlohmann::ordered_json;

Json device_json(const DeviceInfo& device) {
  return {{"name", device.name}, {"driver", device.driver}, {"type", device.type}, {"api", device.api}};
}

Json rays_json(const RayRate& rate) {
  return {{"count", rate.count},
          {"mrays_per_second", rate.mrays_per_second},
          {"spread", rate.spread},
          {"visits", rate.visits},
          {"tests", rate.tests},
          {"bytes", rate.bytes},
          {"lanes_in_use", rate.lanes_in_use},
          {"roofline_fraction", rate.roofline_fraction}};
}

Json embree_json(const BenchResult& result) {
  Json json{{"build_seconds", *result.embree_build_seconds}};
  for (const RayRate& rate : result.rays)
    if (rate.embree)
      json[rate.kind] = {{"ratio", rate.embree->ratio},
                         {"ratio_robust", rate.embree->ratio_robust},
                         {"agreement", rate.embree->agreement}};
  return json;
}

Json queries_json(const QueryComparison& queries) {
  Json json{{"upload_seconds", queries.upload_seconds}, {"bytes", queries.bytes}};
  for (std::size_t kind = 0; kind < kRayKindCount; ++kind)
    if (queries.rays[kind].mrays_per_second > 0.0)
      json[kRayKindNames[kind]] = {{"mrays_per_second", queries.rays[kind].mrays_per_second},
                                   {"ratio", queries.rays[kind].ratio},
                                   {"agreement", queries.rays[kind].agreement}};
  return json;
}

std::string queries_table(const QueryComparison& queries) {
  std::string text = fmt::format("{:<12}{:>9}{:>11}{:>9}   built and uploaded in {:.3f} s, {}\n", "ray queries",
                                 "Mrays/s", "ours over", "agree", queries.upload_seconds, to_size_text(queries.bytes));
  for (std::size_t kind = 0; kind < kRayKindCount; ++kind)
    if (queries.rays[kind].mrays_per_second > 0.0)
      text += fmt::format("{:<12}{:>9.3f}{:>11.2f}{:>9.5f}\n", kRayKindNames[kind], queries.rays[kind].mrays_per_second,
                          queries.rays[kind].ratio, queries.rays[kind].agreement);
  return text;
}

std::string rays_table(const BenchResult& result) {
  std::string text =
      fmt::format("{:<10}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>10}{}\n", "rays", "Mrays/s", "spread", "visits", "tests",
                  "bytes", "lanes", "roofline", result.embree_build_seconds ? "   Embree   robust   agree" : "");
  for (const RayRate& rate : result.rays) {
    if (rate.count == 0) {
      text += fmt::format("{:<10}{:>9}\n", rate.kind, "none");
      continue;
    }
    text += fmt::format("{:<10}{:>9.3f}{:>7.1f} %{:>9.1f}{:>9.1f}{:>9.0f}{:>7.0f} %{:>8.1f} %", rate.kind,
                        rate.mrays_per_second, 100 * rate.spread, rate.visits, rate.tests, rate.bytes,
                        100 * rate.lanes_in_use, 100 * rate.roofline_fraction);
    if (rate.embree)
      text += fmt::format("{:>9.2f}{:>9.2f}{:>8.3f}", rate.embree->ratio, rate.embree->ratio_robust,
                          rate.embree->agreement);
    text += "\n";
  }
  return text;
}

std::string stages_table(const BenchResult& result) {
  double all = 0.0;
  for (const BenchStage& stage : result.stages) all += stage.gpu_ms;
  std::string text = fmt::format("{:<12}{:>10}{:>9}{:>12}\n", "stage", "ms", "share", "dispatches");
  for (const BenchStage& stage : result.stages)
    text += fmt::format("{:<12}{:>10.2f}{:>7.1f} %{:>12}\n", stage.name, stage.gpu_ms,
                        all > 0.0 ? 100 * stage.gpu_ms / all : 0.0, stage.dispatches);
  return text;
}

std::string ablation_table(const std::vector<AblationRow>& rows) {
  std::string text =
      fmt::format("{:<30}{:>10}{:>9}{:>12}{:>12}\n", "left out; would cost", "ms", "share", "memory", "compile ms");
  for (const AblationRow& row : rows)
    text += fmt::format(
        "{:<30}{:>+10.1f}{:>+7.1f} %{:>12}{:>+12.0f}\n", row.left_out, row.cost_ms, 100 * row.cost_ms / row.base_ms,
        row.cost_bytes > 0 ? to_size_text(static_cast<std::uint64_t>(row.cost_bytes)) : "0 bytes", row.cost_compile_ms);
  return text;
}

Json structures_json(const std::vector<StructureRow>& rows) {
  Json json = Json::array();
  for (const StructureRow& row : rows) {
    Json& entry = json.emplace_back(Json{{"name", row.name},
                                         {"build_seconds", row.build_seconds},
                                         {"bytes", row.bytes},
                                         {"items_per_triangle", row.items}});
    for (std::size_t kind = 0; kind < row.mrays_per_second.size(); ++kind)
      if (row.mrays_per_second[kind] > 0.0)
        entry[kRayKindNames[kind]] = {{"mrays_per_second", row.mrays_per_second[kind]},
                                      {"visits", row.visits[kind]},
                                      {"tests", row.tests[kind]},
                                      {"agreement", row.agreement[kind]}};
  }
  return json;
}

std::string structures_table(const std::vector<StructureRow>& rows) {
  std::string text = fmt::format("{:<18}{:>9}{:>12}{:>8}{:>9}{:>9}{:>9}{:>9}\n", "structure", "build s", "memory",
                                 "items", "camera", "bounce", "shadow", "agree");
  for (const StructureRow& row : rows) {
    text +=
        fmt::format("{:<18}{:>9.3f}{:>12}{:>8.2f}", row.name, row.build_seconds, to_size_text(row.bytes), row.items);
    double least = 1.0;
    for (std::size_t kind = 0; kind < row.mrays_per_second.size(); ++kind) {
      const double rate = row.mrays_per_second[kind];
      text += rate > 0.0 ? fmt::format("{:>9.3f}", rate) : fmt::format("{:>9}", "none");
      if (rate > 0.0) least = std::min(least, row.agreement[kind]);
    }
    text += fmt::format("{:>9.4f}\n", least);
  }
  text +=
      "Mrays/s by kind; items that its leaves hold, per triangle; fraction of the rays that find what the first row "
      "does\n";
  text += fmt::format("\n{:<18}{:>15}{:>15}{:>15}\n", "visits + tests", "camera", "bounce", "shadow");
  for (const StructureRow& row : rows) {
    text += fmt::format("{:<18}", row.name);
    for (std::size_t kind = 0; kind < row.mrays_per_second.size(); ++kind)
      text += fmt::format("{:>15}", row.mrays_per_second[kind] > 0.0
                                        ? fmt::format("{:.1f} + {:.1f}", row.visits[kind], row.tests[kind])
                                        : "none");
    text += "\n";
  }
  return text + "inner nodes or cells, and triangles, a ray\n";
}

std::string lamp_table(const std::vector<StructureRow>& rows) {
  std::string text = fmt::format("{:<18}{:>9}{:>12}{:>8}{:>9}{:>9}{:>9}{:>9}\n", "rays to one lamp", "build s",
                                 "memory", "items", "Mrays/s", "visits", "tests", "agree");
  for (const StructureRow& row : rows)
    text += fmt::format("{:<18}{:>9.3f}{:>12}{:>8.2f}{:>9.3f}{:>9.1f}{:>9.1f}{:>9.4f}\n", row.name, row.build_seconds,
                        to_size_text(row.bytes), row.items, row.mrays_per_second[kShadowRaysKind],
                        row.visits[kShadowRaysKind], row.tests[kShadowRaysKind], row.agreement[kShadowRaysKind]);
  return text;
}

} // namespace

Json bench_document(const BenchRun& run) {
  const BenchResult& result = run.result;
  Json rays, stages = Json::array(), ablation = Json::array();
  for (const RayRate& rate : result.rays) rays[rate.kind] = rays_json(rate);
  for (const BenchStage& stage : result.stages)
    stages.push_back({{"name", stage.name}, {"gpu_ms", stage.gpu_ms}, {"dispatches", stage.dispatches}});
  for (const AblationRow& row : result.ablation)
    ablation.push_back({{"left_out", row.left_out},
                        {"cost_ms", row.cost_ms},
                        {"cost_bytes", row.cost_bytes},
                        {"cost_compile_ms", row.cost_compile_ms},
                        {"frame_ms", row.base_ms}});
  Json json{{"device", device_json(run.device)},
            {"scene", run.scene},
            {"size", {run.settings.render.width, run.settings.render.height}},
            {"max_depth", run.settings.render.max_depth},
            {"repetitions", run.settings.repetitions},
            {"triangles", run.packed.triangle_count},
            {"bvh", bvh_json(run.packed)},
            {"rays", rays},
            {"stages", stages},
            {"path_tracing",
             {{"mrays_per_second", result.path_tracing.mrays_per_second},
              {"spread", result.path_tracing.seconds.spread},
              {"traversal_share", result.path_tracing.traversal_fraction},
              {"frame_spp", result.path_tracing.spp},
              {"bytes_per_path", result.path_tracing.bytes_per_path}}},
            {"ceilings",
             {{"load16_per_second", result.ceilings.load16_per_second},
              {"load64_per_second", result.ceilings.load64_per_second},
              {"gflops", result.ceilings.gflops}}},
            {"compile_ms", 1e3 * result.compile_seconds}};
  if (result.embree_build_seconds) json["embree"] = embree_json(result);
  if (result.queries) json["ray_query"] = queries_json(*result.queries);
  json["ablation"] = ablation;
  if (!result.structures.empty()) json["structures"] = structures_json(result.structures);
  if (!result.lamp_structures.empty()) json["lamp_structures"] = structures_json(result.lamp_structures);
  return json;
}

std::string bench_table(const BenchRun& run) {
  const BenchResult& result = run.result;
  const RenderPlan& settings = run.settings.render;
  const Json bvh = bvh_json(run.packed);
  std::string text = fmt::format("{}, {} triangles, {}x{}, at most {} bounces, medians of {}\n{} ({})\n\n", run.scene,
                                 run.packed.triangle_count, settings.width, settings.height, settings.max_depth,
                                 run.settings.repetitions, run.device.name, run.device.driver);
  text += fmt::format(
      "BVH       {}, built in {:.3f} s; SAH {:.1f}, {} nodes, {} copies, {} with the triangles, {:.1f} bytes a "
      "triangle\n",
      bvh["quality"].get<std::string>(), run.packed.bvh_seconds, run.packed.sah_cost, run.packed.nodes.size(),
      bvh["copies"].get<std::uint64_t>(), to_size_text(bvh["bytes"].get<std::uint64_t>()),
      bvh["bytes_per_triangle"].get<double>());
  text += fmt::format("kernels   compiled in {:.0f} ms, no cache\n", 1e3 * result.compile_seconds);
  text += fmt::format("ceilings  {:.0f} M random loads of 16 bytes a second, {:.0f} M of 64, {:.1f} GFLOPS\n\n",
                      1e-6 * result.ceilings.load16_per_second, 1e-6 * result.ceilings.load64_per_second,
                      result.ceilings.gflops);
  text += rays_table(result) + "\n";
  if (result.queries) text += queries_table(*result.queries) + "\n";
  text += stages_table(result);
  text += fmt::format(
      "\npath tracing at {} samples a pixel: {:.3f} Mrays/s (spread {:.1f} %), {:.0f} % of it in traversal, {} bytes a "
      "path\n",
      result.path_tracing.spp, result.path_tracing.mrays_per_second, 100 * result.path_tracing.seconds.spread,
      100 * result.path_tracing.traversal_fraction, result.path_tracing.bytes_per_path);
  if (!result.structures.empty()) text += "\n" + structures_table(result.structures);
  if (!result.lamp_structures.empty()) text += "\n" + lamp_table(result.lamp_structures);
  if (!result.ablation.empty()) text += "\n" + ablation_table(result.ablation);
  return text;
}

Change compare_with_baseline(const Json& now, const Json& before, const std::string& path) try {
  for (const char* key : {"scene", "size", "max_depth"})
    if (now.at(key) != before.at(key))
      throw Error(path, fmt::format("was measured with {} {}, not {}", key, before.at(key).dump(), now.at(key).dump()),
                  "measure both with the same scene and flags");
  if (now.at("device").at("name") != before.at("device").at("name"))
    throw Error(path, "was measured on another device, " + before.at("device").at("name").get<std::string>(),
                "measure both on one device");
  Change change;
  const auto compare = [&](const char* name, const Json& one, const Json& other) {
    const double rate = one.at("mrays_per_second"), rate_before = other.at("mrays_per_second");
    if (!(rate_before > 0.0) || !(rate > 0.0)) return;
    const double percent = 100.0 * (rate / rate_before - 1.0);
    change.text += fmt::format("{:<14}{:>9.3f} Mrays/s, was {:>9.3f}: {:+.1f} %\n", name, rate, rate_before, percent);
    change.worst_percent = std::max(change.worst_percent, -percent);
  };
  for (const char* kind : {"camera", "bounce", "shadow"})
    compare(kind, now.at("rays").at(kind), before.at("rays").at(kind));
  compare("path tracing", now.at("path_tracing"), before.at("path_tracing"));
  return change;
} catch (const Json::exception&) {
  throw Error(path, "is not a document that wavepath bench wrote", "give a file written with --json");
}

} // namespace wavepath
