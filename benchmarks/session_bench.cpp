// What edits of a resident scene cost: session_bench SCENE [NODE [MAP]]. Prints milliseconds: of the edit, of the
// update with those of all processors in brackets and by parts, and of the picture beside its rays.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "host/base/clock.h"
#include "host/session/resolve.h"
#include "host/session/session.h"

namespace wavepath {
namespace {

constexpr int kRepetitions = 7;

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// `edit` gets the number of the repetition, so that each makes a change.
void measure(Session& session, const RenderRequest& render, const char* what, const std::function<void(int)>& edit) {
  std::vector<double> edits, updates, busy, beside, rays;
  SessionUpdate last;
  for (int i = 0; i < kRepetitions; ++i) {
    const Clock::time_point start = Clock::now();
    edit(i);
    edits.push_back(1e3 * seconds_since(start));
    const std::clock_t processors = std::clock();
    last = session.update(render);
    busy.push_back(1e3 * static_cast<double>(std::clock() - processors) / CLOCKS_PER_SEC);
    updates.push_back(last.milliseconds);
    const Clock::time_point drawn = Clock::now();
    const SessionPicture picture = session.render(render);
    rays.push_back(1e3 * picture.result.seconds);
    beside.push_back(1e3 * seconds_since(drawn) - rays.back());
  }
  std::printf("%-13s edit %6.2f  update %7.2f [%7.2f]  picture: rays %7.1f, beside them %6.1f  (", what, median(edits),
              median(updates), median(busy), median(rays), median(beside));
  for (const Redone& part : last.redone) std::printf(" %s %.2f", part.what, part.milliseconds);
  std::printf(" )\n");
}

Environment map_of(int seed) {
  Environment map;
  map.radiance = glm::vec3(1.0f);
  map.width = 2048, map.height = 1024;
  map.map.resize(std::size_t{map.width} * map.height);
  for (std::size_t i = 0; i < map.map.size(); ++i)
    map.map[i] = glm::vec3(0.5f + 0.5f * std::sin(static_cast<float>(i) * 1e-3f + static_cast<float>(seed)));
  return map;
}

int run_all(const std::string& path, std::size_t node, const std::string& map) {
  SessionRequest request;
  request.scene.path = path;
  request.scene.environment = "0.5,0.6,0.7";
  RenderPlan& settings = request.render.settings;
  settings.width = 320, settings.height = 240;
  settings.sample_total = 1;
  request.render.given = {"integrator"};
  resolve_settings(request.scene, request.render);
  Clock::time_point start = Clock::now();
  Session session(request);
  std::printf("opened in %.0f ms", 1e3 * seconds_since(start));
  start = Clock::now();
  session.render(request.render);
  std::printf(", first picture %.0f ms: %zu nodes, %llu triangles\n", 1e3 * seconds_since(start),
              session.scene().node_names.size(), static_cast<unsigned long long>(session.packed().triangle_count));
  const View view = session.view(settings.width, settings.height);
  const RenderRequest& render = request.render;
  measure(session, render, "again", [](int) {});
  measure(session, render, "camera", [&](int i) {
    ViewRequest moved;
    moved.eye = view.position + 0.01 * (i + 1) * view.right;
    moved.look_at = view.position + 5.0 * view.forward;
    session.set_view(moved);
  });
  measure(session, render, "factor", [&](int i) {
    Material material = session.scene().materials[0];
    material.roughness = 0.1f + 0.1f * static_cast<float>(i);
    session.set_material(0, material);
  });
  std::vector<Environment> maps;
  for (int i = 0; i < kRepetitions; ++i) maps.push_back(map_of(i));
  measure(session, render, "map",
          [&](int i) { session.set_environment(std::move(maps[static_cast<std::size_t>(i)])); });
  if (!map.empty()) measure(session, render, "map of a file", [&](int i) { session.set_environment({map, 1.0 + i}); });
  glm::dmat4 matrix = session.matrix(node);
  measure(session, render, "matrix", [&](int) {
    matrix[3].x += 0.01;
    session.set_matrix(node, matrix);
  });
  measure(session, render, "other matrix", [&](int i) { // of a node that has not moved
    const std::size_t other = (node + 1 + static_cast<std::size_t>(i)) % session.scene().node_names.size();
    glm::dmat4 moved = session.matrix(other);
    moved[3].x += 0.01;
    session.set_matrix(other, moved);
  });
  measure(session, render, "visible", [&](int i) { session.set_visible(node, i % 2 != 0); });
  session.set_visible(node, true);
  measure(session, render, "emission", [&](int i) {
    Material material = session.scene().materials[0];
    material.emission = glm::vec3(0.1f * static_cast<float>(i + 1));
    session.set_material(0, material);
  });
  return 0;
}

} // namespace
} // namespace wavepath

int main(int count, char** words) {
  if (count < 2) return std::fprintf(stderr, "usage: session_bench SCENE [NODE [MAP]]\n"), 2;
  try {
    return wavepath::run_all(words[1], count > 2 ? std::strtoul(words[2], nullptr, 10) : 0, count > 3 ? words[3] : "");
  } catch (const std::exception& error) {
    return std::fprintf(stderr, "%s\n", error.what()), 1;
  }
}
