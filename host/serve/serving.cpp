#include "host/serve/serving.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <optional>
#include <utility>

#include <stdlib.h>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/read_file.h"
#include "host/gpu/buffer.h"
#include "host/picture/exposure.h"
#include "host/picture/files/relight.h"
#include "host/picture/picture_format.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/pack/hit_surface.h"
#include "host/scene/pack/pick.h"
#include "host/scene/staging/environment.h"
#include "host/serve/frame.h"
#include "host/serve/report.h"
#include "host/session/viewing/camera_control.h"
#include "host/session/viewing/render_line.h"
#include "host/session/viewing/steering.h"

namespace wavepath {
namespace {

// Seconds.
constexpr double kMotionPause = 1.0 / 60.0; // between pictures while the camera moves, at least,
constexpr double kCoarsePicture = 0.05;     // that one of those may take: half of the window's, as its way is longer
constexpr double kFirstPause = 0.1;         // and while it stands still: at first,
constexpr double kLongestPause = 1.0;       // and at last; it grows with the samples
constexpr double kExactPause = 2.0;         // and where they are stored without loss,
constexpr double kExactRest = 3.0;          // which they are so long after the last change
constexpr double kStatusPause = 0.25;
constexpr double kIdle = 0.1;        // until a viewer, the end or the error is looked for again
constexpr double kRest = 0.15;       // without a move, after which the picture is rendered in full
constexpr double kUnseenRest = 1.0;  // the same where no viewer has been shown the move
constexpr double kDriverRest = 10.0; // without a word of the one who steers, after which whoever asks may
constexpr std::uint32_t kLargest = 4096, kSmallest = 16; // pixels a side that viewers may ask for
constexpr std::size_t kKnownMoves = 64;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

bool stands_alike(const View& a, const View& b) {
  return a.position == b.position && a.forward == b.forward && a.right == b.right && a.up == b.up;
}

// A folder for one file on its way to a viewer.
class PassingFolder {
public:
  PassingFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "wavepath-XXXXXX").string();
    if (!mkdtemp(name.data())) throw Error(name, "cannot be made", "set TMPDIR to a folder that can be written to");
    path_ = name;
  }
  ~PassingFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PassingFolder(PassingFolder&&) = delete;
  const std::filesystem::path& path() const { return path_; }

private:
  std::filesystem::path path_;
};

// Environments that need no file. Viewers name no files: what the server can read is not theirs.
bool needs_no_file(const std::string& source) {
  if (source.empty() || std::ranges::find(kEnvironmentNames, source) != kEnvironmentNames.end()) return true;
  return std::ranges::count(source, ',') == 2 && source.find_first_not_of("0123456789.,eE+-") == std::string::npos;
}

void encode_and_show(Server& server, const FrameHeader& header, const std::vector<std::uint32_t>& screen,
                     std::uint32_t width, std::uint32_t height) {
  server.show(header.number, bytes_of(header) + encode_screen(screen, width, height, FrameQuality::exact));
}

class Serving {
public:
  Serving(ViewedScene& scene, Server& server, const ServingRequest& request)
      : request_(request),
        scene_(scene),
        render_(scene.render()),
        server_(server),
        camera_(scene.session().scene(), request.framing, scene.session().scene_request().view),
        display_(*scene.session().device().device),
        settings_(render_.settings()),
        shown_(request.display),
        environment_(environment_of(scene.session().scene_request())),
        first_environment_(environment_.source),
        target_error_(request.target_error) {
    camera_.resize(settings_.width, settings_.height);
    render_.set_coarse_seconds(kCoarsePicture);
    scene_.move(camera_.request()); // so that the first picture is a coarse one, which comes soon
    last_move_ = seconds_now();
  }

  void run() {
    bool worked = true;
    while (!request_.ends()) {
      for (const ViewerNews& news : server_.take(worked ? 0.0 : pause())) take(news);
      apply();
      if (may_rest()) scene_.rest();
      send_files();
      worked = (has_work() || status_.done) && scene_.step(); // once done, it takes in the last estimate of the error
      status_ = render_.status();
      choose_exposure();
      show_picture();
      tell_status();
    }
  }

private:
  // What viewers want.
  void take(const ViewerNews& news);
  void take(std::uint32_t viewer, const Message& message);
  void steer_by(const Message& message);
  void take_camera(const Message& message);
  void take_setting(const Message& message);
  void take_size(const Message& message);
  void take_display(const Message& message);
  void take_environment(const Message& message);
  void focus(const glm::dvec2& at);
  void pick_at(std::uint32_t viewer, const glm::dvec2& at);
  void ask_for_control(std::uint32_t viewer);
  void let_steer(std::uint32_t viewer);
  void apply();
  void take_settings();
  bool may_rest() const;
  void send_files();
  void send_file(std::uint32_t request, const std::string& format);

  // What they get.
  bool has_work() const;
  double pause() const;
  void choose_exposure();
  void show_picture();
  void tell_status();
  void tell_scene();
  std::string scene_report() const;
  std::string command() const;
  std::uint32_t shown_count();
  bool encodes() const {
    return encoding_.valid() && encoding_.wait_for(std::chrono::seconds(0)) != std::future_status::ready;
  }

  const ServingRequest& request_;
  ViewedScene& scene_;
  Progressive& render_; // of it
  Server& server_;
  CameraControl camera_;
  Display display_;
  RenderPlan settings_; // asked for
  DisplayOptions shown_;
  EnvironmentRequest environment_; // in use
  const std::string first_environment_;
  double target_error_;
  ProgressiveStatus status_;

  std::vector<std::uint32_t> viewers_; // in the order of their coming
  std::uint32_t driver_ = 0;           // who steers; 0 = nobody is there
  std::optional<std::uint32_t> asks_;  // who would like to
  double last_driven_ = 0.0;

  bool moved_ = false, changed_ = false, dragging_ = false;
  std::uint32_t last_count_ = 0;
  std::deque<std::pair<View, std::uint32_t>> moves_; // and the count of the message that made each
  double last_move_ = 0.0;
  std::map<std::uint32_t, glm::dvec2> picks_;                // the last one of each viewer
  std::vector<std::pair<std::uint32_t, std::string>> files_; // requests that wait, and their formats

  std::uint32_t frame_ = 0, frame_spp_ = 0, frame_coarse_ = 0, frame_count_ = 0; // of the last picture
  bool frame_exact_ = false, frame_done_ = false, must_draw_ = true;
  double last_frame_ = 0.0, last_change_ = 0.0, last_status_ = 0.0;
  std::uint32_t exposed_spp_ = 0;
  bool exposed_ = false;
  std::string told_status_;
  std::future<void> encoding_; // of a picture without loss, which takes long: a move does not wait for it
};

void Serving::take(const ViewerNews& news) {
  switch (news.kind) {
    case ViewerNews::Kind::joined:
      viewers_.push_back(news.viewer);
      last_change_ = seconds_now(); // the first picture is to come soon, and that without loss later
      server_.send(news.viewer, scene_report());
      server_.send(news.viewer, told_status_.empty() ? status_json({.status = status_}) : told_status_);
      if (driver_ == 0)
        let_steer(news.viewer);
      else
        server_.send(news.viewer, role_json(false, false));
      return;
    case ViewerNews::Kind::left:
      std::erase(viewers_, news.viewer);
      picks_.erase(news.viewer);
      if (asks_ == news.viewer) asks_.reset();
      if (driver_ == news.viewer) {
        dragging_ = false;
        driver_ = 0;
        if (!viewers_.empty()) let_steer(asks_.value_or(viewers_.front()));
      }
      return;
    case ViewerNews::Kind::wants_file:
      files_.emplace_back(news.viewer, news.format);
      return;
    case ViewerNews::Kind::message:
      try {
        take(news.viewer, news.message);
      } catch (const Error& error) {
        server_.send(news.viewer, note_json(error.what()));
        server_.send(news.viewer, scene_report());
      }
  }
}

void Serving::take(std::uint32_t viewer, const Message& message) {
  if (message.kind == MessageKind::take) return ask_for_control(viewer);
  if (message.kind == MessageKind::pick) {
    picks_[viewer] = message.at;
    return;
  }
  if (message.kind == MessageKind::copy) return server_.send(viewer, copied_json(command()));
  if (viewer != driver_) return server_.send(viewer, note_json("another viewer steers; ask for control first"));
  last_driven_ = seconds_now();
  last_count_ = message.count;
  switch (message.kind) {
    case MessageKind::steer:
      return steer_by(message);
    case MessageKind::view:
    case MessageKind::camera:
      return take_camera(message);
    case MessageKind::focus:
      return focus(message.at);
    case MessageKind::set:
      return take_setting(message);
    case MessageKind::size:
      return take_size(message);
    case MessageKind::display:
      return take_display(message);
    case MessageKind::environment:
      return take_environment(message);
    case MessageKind::target:
      target_error_ = message.error;
      return tell_scene();
    case MessageKind::give:
      if (asks_) let_steer(*asks_);
      return;
    default:
      return;
  }
}

void Serving::steer_by(const Message& message) {
  dragging_ = message.dragging;
  if (steer(camera_, message.drags, message.flight, message.seconds)) moved_ = true;
}

void Serving::take_camera(const Message& message) {
  if (message.kind == MessageKind::view) {
    CameraControl wanted = camera_;
    wanted.see(message.view);
    wanted.view(); // throws where there is no such view
    camera_ = std::move(wanted);
  } else if (message.name == "reset") {
    camera_.reset();
  } else if (message.name == "frame") {
    camera_.frame_scene();
  } else {
    const bool is_index = !message.name.empty() && message.name.size() < 9 &&
                          message.name.find_first_not_of("0123456789") == std::string::npos;
    if (!is_index || !camera_.choose(static_cast<std::size_t>(std::stoul(message.name))))
      throw Error("camera " + message.name, "is none of the scene", "name one of its cameras, reset or frame");
  }
  moved_ = true;
}

void Serving::focus(const glm::dvec2& at) {
  const bool passes_backs = settings_.cull != gpu::kCullNone;
  const auto point = pick(scene_.session().packed(), camera_.view(), at, glm::dvec2(1.0), passes_backs);
  if (!point || !camera_.focus(*point)) return;
  if (settings_.lens.focus) { // else the lens follows what the middle of the picture shows, which this is now
    settings_.lens.focus = depth_of(camera_.view(), *point);
    changed_ = true;
  }
  moved_ = true;
}

void Serving::take_setting(const Message& message) {
  const auto rows = settings_table();
  const auto row = std::ranges::find(rows, message.name, &Setting::name);
  if (row == rows.end() || !is_viewed(*row, *settings_.integrator))
    throw Error(message.name, "is no setting of this picture", "choose from those that are shown");
  const std::uint32_t planned = settings_.sample_total;
  RenderPlan wanted = settings_;
  if (const auto* on = std::get_if<SwitchValue>(&row->value))
    wanted.*on->member = message.value == "on";
  else
    read_setting(*row, message.value, wanted);
  settle(wanted, planned);
  settings_ = wanted;
  changed_ = true;
}

void Serving::take_size(const Message& message) {
  const auto fits = [](std::uint32_t side) { return side >= kSmallest && side <= kLargest; };
  if (!fits(message.width) || !fits(message.height))
    throw Error(fmt::format("{}x{}", message.width, message.height), "is no size to look at",
                fmt::format("give {} to {} pixels a side", kSmallest, kLargest));
  settings_.width = message.width, settings_.height = message.height;
  camera_.resize(message.width, message.height);
  changed_ = true;
}

void Serving::take_display(const Message& message) {
  DisplayOptions wanted = shown_;
  if (message.shown) {
    const auto found = std::ranges::find(kShownNames, *message.shown);
    wanted.shown = static_cast<Shown>(found - kShownNames.begin());
    if (found == kShownNames.end() || wanted.shown == Shown::shadow_error ||
        !can_show(*settings_.integrator, wanted.shown))
      throw Error(*message.shown, "is nothing that this picture can show", "choose from the names that are offered");
    // Channels once rendered stay, so that looking at them by turns does not begin anew each time.
    for (const std::string& aov : aovs_for(wanted.shown))
      if (std::ranges::find(settings_.aovs, aov) == settings_.aovs.end())
        settings_.aovs.push_back(aov), changed_ = true;
  }
  if (message.tonemap) {
    const auto found = std::ranges::find(kTonemapNames, *message.tonemap);
    if (found == std::end(kTonemapNames))
      throw Error(*message.tonemap, "is no tone curve", "choose one that is offered");
    wanted.tonemap = static_cast<Tonemap>(found - std::begin(kTonemapNames));
  }
  if (message.exposure) wanted.exposure = *message.exposure, wanted.auto_exposure = false;
  if (message.auto_exposure) wanted.auto_exposure = true, exposed_spp_ = 0, exposed_ = false;
  if (message.gains.size() == settings_.group_names.size()) wanted.group_gains = message.gains;
  shown_ = wanted;
  must_draw_ = true;
  tell_scene();
}

void Serving::take_environment(const Message& message) {
  EnvironmentRequest wanted = message.environment;
  if (!needs_no_file(wanted.source) && wanted.source != first_environment_)
    throw Error(wanted.source, "would be read from the server's disk",
                "give R,G,B or a name that is offered, or begin with --env FILE");
  if (wanted == environment_) return;
  scene_.set_environment(wanted);
  environment_ = wanted;
  last_change_ = seconds_now();
  tell_scene();
}

void Serving::pick_at(std::uint32_t viewer, const glm::dvec2& at) {
  if (render_.spp() == 0) return server_.send(viewer, note_json("there is no picture yet"));
  const PackedScene& packed = scene_.session().packed();
  const Picture picture = render_.picture();
  PickReport report{.at = at, .spp = render_.spp()};
  const auto index = [](double position, std::uint32_t size) {
    return std::min(static_cast<std::uint32_t>(position * size), size - 1);
  };
  report.x = index(at.x, settings_.width), report.y = index(at.y, settings_.height);
  const std::size_t pixel = std::size_t{index(at.y, picture.height)} * picture.width + index(at.x, picture.width);
  for (const Channel& channel : picture.channels) report.values.emplace_back(channel.name, channel.values[pixel]);
  const bool passes_backs = settings_.cull != gpu::kCullNone;
  if (const auto surface = pick_surface(packed, render_.view(), at, glm::dvec2(1.0), passes_backs)) {
    report.point = surface->point;
    report.distance = surface->distance;
    if (const std::uint32_t node = node_of(packed, surface->hit); node != kNoIndex) {
      const bool named = node < packed.node_names.size() && !packed.node_names[node].empty();
      report.node = named ? packed.node_names[node] : fmt::format("node {}", node);
    }
    const std::uint32_t material = material_of(packed, surface->hit);
    const bool named = material < packed.material_names.size() && !packed.material_names[material].empty();
    report.material = named ? packed.material_names[material] : fmt::format("material {}", material);
  }
  server_.send(viewer, pick_json(report));
}

// Given at once where nobody steers, or has for a while; else that one is asked.
void Serving::ask_for_control(std::uint32_t viewer) {
  if (viewer == driver_) return;
  if (driver_ == 0 || seconds_now() - last_driven_ >= kDriverRest) return let_steer(viewer);
  asks_ = viewer;
  server_.send(driver_, role_json(true, true));
  server_.send(viewer, note_json("asked; the other viewer steers until it lets go"));
}

void Serving::let_steer(std::uint32_t viewer) {
  if (driver_ != 0 && driver_ != viewer) server_.send(driver_, role_json(false, false));
  driver_ = viewer;
  last_driven_ = seconds_now();
  dragging_ = false;
  asks_.reset();
  server_.send(viewer, role_json(true, false));
}

// What the messages so far have asked for, at once.
void Serving::apply() {
  if (changed_) {
    changed_ = moved_ = false;
    take_settings();
  }
  if (std::exchange(moved_, false)) {
    scene_.move(camera_.request());
    last_move_ = last_change_ = seconds_now();
    moves_.emplace_back(scene_.session().view(settings_.width, settings_.height), last_count_);
    if (moves_.size() > kKnownMoves) moves_.pop_front();
  }
  for (const auto& [viewer, at] : std::exchange(picks_, {})) pick_at(viewer, at);
}

void Serving::take_settings() {
  last_change_ = seconds_now();
  try {
    scene_.set_settings(settings_, camera_.request());
    shown_.group_gains.resize(settings_.group_names.size(), 1.0f);
    if (!can_show(*settings_.integrator, shown_.shown)) shown_.shown = Shown::color;
  } catch (const Error& error) {
    settings_ = render_.settings();
    camera_.resize(settings_.width, settings_.height);
    if (driver_) server_.send(driver_, note_json(error.what()));
  }
  must_draw_ = true;
  tell_scene();
}

// A move has been shown before the picture is rendered in full, however short it was.
bool Serving::may_rest() const {
  if (!render_.moving() || dragging_) return false;
  const double still = seconds_now() - last_move_;
  const bool is_shown = frame_ > 0 && (moves_.empty() || frame_count_ == moves_.back().second);
  return render_.spp() > 0 && still >= (is_shown ? kRest : kUnseenRest);
}

// While the camera moves, a picture is a coarse one.
void Serving::send_files() {
  if (files_.empty() || render_.spp() == 0 || render_.coarse() > 1 || render_.moving()) return;
  for (const auto& [request, format] : std::exchange(files_, {})) send_file(request, format);
}

void Serving::send_file(std::uint32_t request, const std::string& format) try {
  const PassingFolder folder;
  const std::string stem = std::filesystem::path(scene_.session().scene().path).stem().string();
  std::string name; // letters that a header can hold
  for (const char c : stem) name += std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-' ? c : '_';
  name += "." + format;
  const std::string path = (folder.path() / ("picture." + format)).string();
  Picture picture = render_.picture();
  // An EXR keeps the groups apart, for `wavepath relight`.
  if (shown_.mixes() && picture_format(path) != PictureFormat::exr)
    relight(path, settings_.group_names, gains_of(settings_, shown_), picture);
  request_.save(path, picture, shown_);
  const auto bytes = read_whole_file(path);
  if (!bytes) throw Error(path, "cannot be read", "look whether the disk is full");
  server_.answer_file(request, name, std::string(bytes->begin(), bytes->end()));
} catch (const Error& error) {
  server_.refuse_file(request, error.what());
}

bool Serving::has_work() const {
  if (status_.done) return false;
  const bool reached = target_error_ > 0.0 && status_.error_spp > 0 && status_.error.relative_rms <= target_error_ &&
                       status_.coarse == 1;
  // Before anybody comes, one picture is made ready.
  return !reached && (!viewers_.empty() || status_.spp == 0);
}

double Serving::pause() const { return has_work() || render_.moving() ? 0.005 : kIdle; }

// Chosen as the window does: when a render that began anew has a sample of every pixel, at eight times the samples, and
// when it is done. While the camera moves it stays.
void Serving::choose_exposure() {
  if (status_.spp < exposed_spp_ || status_.spp == 0) exposed_spp_ = 0;
  if (!shown_.auto_exposure || status_.spp == 0 || (exposed_ && status_.coarse > 1)) return;
  const bool due = status_.spp >= 8 * exposed_spp_ || (status_.done && status_.spp > exposed_spp_);
  if (!due) return;
  const double exposure = auto_exposure(render_.picture());
  must_draw_ |= exposure != shown_.exposure;
  shown_.exposure = exposure;
  exposed_ = true;
  exposed_spp_ = status_.coarse > 1 ? 0 : status_.spp;
}

// The count of the message whose view the picture has. A picture that was begun by an earlier move may be due first.
std::uint32_t Serving::shown_count() {
  for (auto move = moves_.rbegin(); move != moves_.rend(); ++move)
    if (stands_alike(move->first, render_.view())) return move->second;
  return frame_count_;
}

void Serving::show_picture() {
  if (status_.spp == 0 || !server_.wants_frame()) return;
  const double now = seconds_now(), since = now - last_frame_;
  const std::uint32_t count = shown_count();
  const bool anew = count != frame_count_ || status_.coarse != frame_coarse_ || status_.spp < frame_spp_ || must_draw_;
  const bool exact = status_.done || (status_.coarse == 1 && now - last_change_ >= kExactRest);
  const bool news = anew || status_.spp != frame_spp_ || (exact && !frame_exact_) || status_.done != frame_done_;
  if (!news) return;
  double least = kMotionPause;
  if (!anew && status_.coarse == 1 && !status_.done) {
    const double grown = kFirstPause * std::sqrt(static_cast<double>(std::max(frame_spp_, 1u)));
    least = exact ? kExactPause : std::min(grown, kLongestPause);
  }
  if (since < least || (exact && encodes())) return;
  DisplayOptions options = shown_;
  options.coarse = true; // browsers enlarge it
  display_.draw(render_, options);
  FrameHeader header;
  header.number = ++frame_;
  header.count = count;
  header.spp = status_.spp;
  header.coarse = static_cast<std::uint16_t>(status_.coarse);
  header.format = exact ? FrameFormat::png : FrameFormat::jpeg;
  header.done = status_.done ? 1 : 0;
  header.width = static_cast<std::uint16_t>(settings_.width);
  header.height = static_cast<std::uint16_t>(settings_.height);
  if (status_.error_spp > 0) header.error = static_cast<float>(status_.error.relative_rms);
  header.seconds = static_cast<float>(status_.seconds);
  const std::size_t pixels = std::size_t{display_.width()} * display_.height();
  if (exact) {
    encoding_ = std::async(std::launch::async, encode_and_show, std::ref(server_), header,
                           download<std::uint32_t>(display_.pixels(), pixels), display_.width(), display_.height());
  } else {
    std::vector<std::uint32_t> copy;
    const auto screen = look_at(display_.pixels(), pixels, copy);
    const FrameQuality quality = status_.coarse > 1 ? FrameQuality::motion : FrameQuality::rendering;
    server_.show(header.number, bytes_of(header) + encode_screen(screen, display_.width(), display_.height(), quality));
  }
  frame_spp_ = status_.spp, frame_coarse_ = status_.coarse, frame_count_ = count;
  frame_exact_ = exact, frame_done_ = status_.done, must_draw_ = false;
  last_frame_ = seconds_now();
}

void Serving::tell_status() {
  const double now = seconds_now();
  if (viewers_.empty() || now - last_status_ < kStatusPause) return;
  last_status_ = now;
  StatusReport report{.status = status_, .exposure = shown_.exposure, .target_error = target_error_};
  report.viewers = viewers_.size();
  if (target_error_ > 0.0) report.seconds_to_target = render_.seconds_to(target_error_);
  report.reached = target_error_ > 0.0 && status_.error_spp > 0 && status_.error.relative_rms <= target_error_;
  std::string text = status_json(report);
  if (text == told_status_) return;
  told_status_ = text;
  server_.send_status(std::move(text));
}

void Serving::tell_scene() {
  if (!viewers_.empty()) server_.send_to_all(scene_report());
}

std::string Serving::scene_report() const {
  Session& session = scene_.session();
  const Scene& scene = session.scene();
  SceneReport report;
  report.scene = std::filesystem::path(scene.path).filename().string();
  report.device = session.device_info().name;
  report.light = session.light();
  report.triangles = session.packed().triangle_count;
  report.lights = session.packed().lights.size();
  for (const Camera& camera : scene.cameras) report.cameras.push_back(camera.name);
  report.notes = request_.notes(render_.settings());
  for (const auto& [text, count] : scene.warnings.counts()) report.notes.push_back(text);
  report.plan = request_.plan(render_.settings());
  report.environment = environment_;
  report.environments.emplace_back("");
  for (const std::string_view name : kEnvironmentNames) report.environments.emplace_back(name);
  if (!needs_no_file(first_environment_)) report.environments.push_back(first_environment_);
  report.settings = render_.settings();
  report.display = shown_;
  report.target_error = target_error_;
  return scene_json(report);
}

std::string Serving::command() const {
  return render_line(scene_.session().scene().path, camera_.request(), render_.settings(), shown_,
                     request_.more_flags());
}

} // namespace

void serve_scene(ViewedScene& scene, Server& server, const ServingRequest& request) {
  Serving(scene, server, request).run();
}

} // namespace wavepath
