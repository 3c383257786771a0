#include "host/view/window.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/picture/exposure.h"
#include "host/picture/files/relight.h"
#include "host/picture/picture_format.h"
#include "host/render/progressive/shadow_comparison.h"
#include "host/render/settings/settings_table.h"
#include "host/scene/pack/pick.h"
#include "host/session/viewing/camera_control.h"
#include "host/session/viewing/render_line.h"
#include "host/session/viewing/steering.h"
#include "host/view/divider.h"
#include "host/view/glfw.h"
#include "host/view/overlay.h"
#include "host/view/panel.h"
#include "host/view/presenter.h"

namespace wavepath {
namespace {

// Seconds.
constexpr double kPicturePause = 1.0 / 60.0; // between pictures while the user gives input,
constexpr double kRenderPause = 1.0 / 15.0;  // and while only the render goes on
constexpr double kIdlePause = 0.25;          // until the estimate of the error is looked for again
constexpr double kAdaption = 0.15;           // in which the automatic exposure does two thirds of its way
constexpr double kRest = 0.15;               // without a move, after which the picture is rendered in full
constexpr int kSettling = 3;                 // pictures after an event until widgets show what came of it

bool same(const ProgressiveStatus& a, const ProgressiveStatus& b) {
  return a.compiling == b.compiling && a.done == b.done && a.coarse == b.coarse && a.fraction == b.fraction &&
         a.error_spp == b.error_spp;
}

// STEM-0001.EXTENSION, or the first number that is not taken.
std::string free_name(const std::string& scene, const char* extension) {
  const std::string stem = std::filesystem::path(scene).stem().string();
  for (int i = 1;; ++i) {
    const std::string name = fmt::format("{}-{:04}.{}", stem, i, extension);
    std::error_code error;
    if (!std::filesystem::exists(name, error)) return name;
  }
}

class Viewer {
public:
  Viewer(ViewedScene& scene, const WindowRequest& request);
  ~Viewer() { presenter_.wait(); } // before anything goes that the device may be showing
  int run();

private:
  void wait_for_events();
  bool must_draw(double now);
  void draw(double now);
  void take_input(double seconds);
  void press(const KeyPress& key);
  Flight flight() const;
  void focus();
  void fit_size();
  void move_camera();
  void take_settings();
  void act(const PanelWishes& wishes);
  void save(const char* extension);
  void save_what_waits();
  bool resizing() const;
  void write(const std::string& path);
  void mix_groups(const std::string& path, Picture& picture) const;
  bool compares() const;
  // The map of errors is of both, and shown whole.
  bool splits() const {
    return scene_.comparison() && panel_.comparison.split && panel_.display.shown != Shown::shadow_error;
  }
  void make_comparison();
  void fit_comparison();
  void judge_shadows();
  void draw_picture();
  bool done() const { return status_.done && (!scene_.comparison() || scene_.comparison()->is_done()); }
  void copy();
  void choose_exposure();
  void adapt_exposure(double seconds);
  void show_title();
  PanelFacts facts() const;
  bool target_reached() const;
  bool seen() const { return window_.size().x > 0; }
  bool scripted() const { return request_.frames > 0; }
  // A scripted window ends at its number of samples alone, so that its picture is the same every time.
  bool has_work() const { return !done() && (scripted() || (seen() && !target_reached())); }

  const WindowRequest& request_;
  ViewedScene& scene_;
  Progressive& render_; // of it
  CameraControl camera_;
  GlfwWindow window_;
  Presenter presenter_;
  Overlay overlay_;
  Display display_;
  PanelState panel_;
  ProgressiveStatus status_, shown_;
  EnvironmentRequest environment_; // in use
  ShadowVerdict verdict_;
  std::uint32_t judged_spp_ = 0;    // samples a pixel that it was found at; 0 = not since anything changed
  std::uint64_t drawn_samples_ = 0; // of the comparison
  Divider divider_;
  std::string title_;
  double exposure_ = 0.0;         // that the picture asks for
  std::uint32_t exposed_spp_ = 0; // samples a pixel that it was chosen at; 0 = not since the render began anew
  bool exposed_ = false;          // it was chosen at all
  int redraws_ = kSettling;
  bool worked_ = false, drawn_done_ = false;
  std::vector<std::string> waiting_; // extensions of pictures to save
  double last_draw_ = 0.0, last_move_ = 0.0;
  glm::uvec2 resizing_to_{0}, refused_{0};
  double resized_ = -1.0; // when the window's size changed; below zero: it has not
};

Viewer::Viewer(ViewedScene& scene, const WindowRequest& request)
    : request_(request),
      scene_(scene),
      render_(scene.render()),
      camera_(scene.session().scene(), request.framing, scene.session().scene_request().view),
      window_(request.title, render_.settings().width, render_.settings().height),
      presenter_(*scene.session().device().device, window_),
      overlay_(*scene.session().device().device, window_, presenter_.swapchain(), Presenter::kPresentationsInFlight),
      display_(*scene.session().device().device),
      environment_(environment_of(scene.session().scene_request())) {
  panel_.settings = render_.settings();
  panel_.display = request.display;
  panel_.display.bgra = presenter_.swapchain().bgra();
  panel_.environment = environment_;
  panel_.variant = scene_.session().scene_request().load.variant;
  panel_.target_error = request.target_error;
  panel_.comparison = request.comparison;
  camera_.resize(panel_.settings.width, panel_.settings.height);
  if (compares()) make_comparison();
}

int Viewer::run() {
  while (!window_.should_close()) {
    wait_for_events();
    status_ = render_.status();
    choose_exposure();
    if (const double now = glfwGetTime(); must_draw(now)) draw(now);
    worked_ = (has_work() || done()) && scene_.step(); // once done, it takes in the last estimate of the error
    status_ = render_.status();
    save_what_waits();
    if (scripted() && done() && (drawn_done_ || !seen())) {
      if (!request_.screenshot.empty()) write(request_.screenshot);
      break;
    }
  }
  return 0;
}

// Sleeps unless there is something to render or to draw.
void Viewer::wait_for_events() {
  const bool active = render_.moving() || resized_ >= 0.0 || redraws_ > 0;
  const bool due = glfwGetTime() - last_draw_ >= kPicturePause;
  if (worked_ || (active && due && seen()))
    glfwPollEvents();
  else
    glfwWaitEventsTimeout(seen() && (active || has_work()) ? kPicturePause : kIdlePause);
}

bool Viewer::must_draw(double now) {
  if (window_.take_events()) redraws_ = kSettling;
  if (!seen()) return false;
  if (now - last_draw_ < kPicturePause) return false;
  const ShadowComparison* comparison = scene_.comparison();
  const bool news = !same(status_, shown_) || (comparison && comparison->samples() != drawn_samples_);
  return redraws_ > 0 || render_.moving() || resized_ >= 0.0 || (news && (done() || now - last_draw_ >= kRenderPause));
}

void Viewer::draw(double now) {
  overlay_.begin();
  take_input(now - last_draw_);
  fit_size();
  if (render_.moving() && !window_.dragging() && now - last_move_ >= kRest) scene_.rest();
  status_ = render_.status();
  adapt_exposure(now - last_draw_);
  judge_shadows();
  const PanelWishes wishes = show_panel(panel_, facts());
  if (splits()) {
    const Setting& shadows = setting_named("shadows");
    draw_divider(panel_.comparison.at, text_of(shadows, panel_.settings),
                 std::string(choices_of(shadows)[scene_.comparison()->against()]));
  }
  overlay_.end();
  act(wishes);

  presenter_.wait(); // the display may make its buffer anew
  draw_picture();
  const bool presented = presenter_.present(display_.pixels(), display_.width(), display_.height(), overlay_);
  if (presented) {
    redraws_ = std::max(0, redraws_ - 1);
    shown_ = status_;
  }
  drawn_done_ = done();
  drawn_samples_ = scene_.comparison() ? scene_.comparison()->samples() : 0;
  last_draw_ = now;
  show_title();
}

void Viewer::take_input(double seconds) {
  Input input = window_.take_input();
  if (overlay_.wants_pointer()) {
    input = Input{.keys = std::move(input.keys), .pointer = input.pointer};
    window_.drop_pointer();
  }
  if (splits()) divider_.take(input, window_.dragging(), window_.size().x, panel_.comparison.at);
  if (input.double_click || input.control_click) focus();
  Flight flight;
  if (!overlay_.wants_keys()) {
    flight = this->flight();
    for (const KeyPress& key : input.keys) press(key);
  }
  const double height = std::max(1u, window_.size().y);
  const Drags drags{.left = input.drag_left / height,
                    .middle = input.drag_middle / height,
                    .right = input.drag_right / height,
                    .scroll = input.scroll,
                    .shift = (input.modifiers & GLFW_MOD_SHIFT) != 0};
  if (steer(camera_, drags, flight, seconds)) move_camera();
}

Flight Viewer::flight() const {
  const auto axis = [this](int forwards, int backwards) {
    return (window_.held(forwards) ? 1.0 : 0.0) - (window_.held(backwards) ? 1.0 : 0.0);
  };
  return {{axis(GLFW_KEY_D, GLFW_KEY_A), axis(GLFW_KEY_E, GLFW_KEY_Q), axis(GLFW_KEY_W, GLFW_KEY_S)},
          window_.held(GLFW_KEY_LEFT_SHIFT) || window_.held(GLFW_KEY_RIGHT_SHIFT)};
}

void Viewer::press(const KeyPress& key) {
  PanelWishes wishes;
  if (key.modifiers & GLFW_MOD_CONTROL) {
    if (key.key == GLFW_KEY_Q) glfwSetWindowShouldClose(window_.handle(), GLFW_TRUE);
    return;
  }
  switch (key.key) {
    case GLFW_KEY_H:
    case GLFW_KEY_TAB:
      panel_.visible = !panel_.visible;
      break;
    case GLFW_KEY_C:
      wishes.copy = true;
      break;
    case GLFW_KEY_X:
      wishes.save_exr = true;
      break;
    case GLFW_KEY_P:
      wishes.save_png = true;
      break;
    case GLFW_KEY_R:
      wishes.reset = true;
      break;
    case GLFW_KEY_HOME:
      wishes.frame = true;
      break;
    case GLFW_KEY_F:
      focus();
      break;
    default:
      if (key.key >= GLFW_KEY_1 && key.key <= GLFW_KEY_9) wishes.camera = key.key - GLFW_KEY_1;
  }
  act(wishes);
}

void Viewer::focus() {
  const bool passes_backs = panel_.settings.cull != gpu::kCullNone;
  const auto point =
      pick(scene_.session().packed(), camera_.view(), window_.pointer(), glm::dvec2(window_.size()), passes_backs);
  if (!point || !camera_.focus(*point)) return;
  if (panel_.settings.lens.focus) { // else the lens follows what the middle of the picture shows, which this is now
    panel_.settings.lens.focus = depth_of(camera_.view(), *point);
    take_settings();
  }
  move_camera();
}

// True if the picture must follow the window's new size. A scripted window keeps the size that was asked for.
bool Viewer::resizing() const {
  const glm::uvec2 size = window_.size();
  const RenderPlan& settings = render_.settings();
  return !scripted() && size.x > 0 && size != refused_ && (size.x != settings.width || size.y != settings.height);
}

// The picture follows the window once its edges have come to rest.
void Viewer::fit_size() {
  const glm::uvec2 size = window_.size();
  const RenderPlan& settings = render_.settings();
  if (!resizing()) {
    resized_ = -1.0;
    return;
  }
  if (resized_ < 0.0 || size != resizing_to_) resized_ = glfwGetTime(), resizing_to_ = size;
  if (glfwGetTime() - resized_ < kRest) return;
  panel_.settings.width = size.x, panel_.settings.height = size.y;
  camera_.resize(size.x, size.y);
  presenter_.wait();
  take_settings();
  refused_ = settings.width == size.x && settings.height == size.y ? glm::uvec2(0) : size; // too large to try each time
}

void Viewer::move_camera() {
  last_move_ = glfwGetTime();
  judged_spp_ = 0;
  scene_.move(camera_.request());
}

void Viewer::take_settings() {
  judged_spp_ = 0;
  try {
    scene_.set_settings(panel_.settings, camera_.request());
    panel_.message.clear();
  } catch (const Error& error) {
    panel_.message = error.what();
    panel_.settings = render_.settings();
    camera_.resize(panel_.settings.width, panel_.settings.height);
  }
}

void Viewer::act(const PanelWishes& wishes) {
  // Channels once rendered stay, so that looking at them by turns does not begin anew each time.
  bool more_channels = false;
  const auto add = [&](const std::string& aov) {
    auto& aovs = panel_.settings.aovs;
    if (std::find(aovs.begin(), aovs.end(), aov) == aovs.end()) aovs.push_back(aov), more_channels = true;
  };
  if (can_show(*panel_.settings.integrator, panel_.display.shown))
    for (const std::string& aov : aovs_for(panel_.display.shown)) add(aov);
  if (compares()) add("direct");
  if (wishes.settings || more_channels) take_settings();
  if (wishes.environment && panel_.environment != environment_) try {
      scene_.set_environment(panel_.environment);
      environment_ = panel_.environment;
      panel_.message.clear();
    } catch (const Error& error) {
      panel_.message = error.what();
      panel_.environment = environment_;
    }
  if (wishes.variant) try {
      scene_.set_variant(panel_.variant);
      panel_.message.clear();
    } catch (const Error& error) {
      panel_.message = error.what();
      panel_.variant = scene_.session().scene_request().load.variant;
    }
  fit_comparison();
  if (wishes.reset) camera_.reset();
  if (wishes.frame) camera_.frame_scene();
  bool chosen = false;
  if (wishes.camera) try {
      chosen = camera_.choose(*wishes.camera);
    } catch (const Error& error) {
      panel_.message = error.what();
    }
  if (wishes.reset || wishes.frame || chosen) move_camera();
  if (wishes.copy) copy();
  if (wishes.save_exr) save("exr");
  if (wishes.save_png) save("png");
}

void Viewer::save(const char* extension) {
  waiting_.emplace_back(extension);
  save_what_waits();
  if (!waiting_.empty()) panel_.message = "saving once the picture is whole";
}

// While the window is resized or the camera moves, a picture is a coarse one, or has another size than the window.
void Viewer::save_what_waits() {
  if (waiting_.empty() || resizing() || render_.moving() || render_.coarse() > 1 || render_.spp() == 0) return;
  for (const std::string& extension : std::exchange(waiting_, {})) try {
      const std::string name = free_name(scene_.session().scene().path, extension.c_str());
      write(name);
      panel_.message = "saved " + name;
    } catch (const Error& error) {
      panel_.message = error.what();
    }
  redraws_ = kSettling; // of the message
}

// The picture as it is shown: split, or where its shadows are false.
void Viewer::write(const std::string& path) {
  DisplayOptions display = panel_.display;
  if (scene_.comparison() && display.shown == Shown::shadow_error) {
    if (const Picture map = scene_.comparison()->judge().map; !map.channels.empty()) {
      display.auto_exposure = false, display.exposure = 0.0, display.tonemap = Tonemap::none;
      return request_.save(path, map, display);
    }
  }
  Picture picture = render_.picture();
  if (splits()) {
    if (display.auto_exposure) display.exposure = auto_exposure(picture), display.auto_exposure = false;
    const Picture truth = scene_.comparison()->truth().picture();
    if (truth.width == picture.width && truth.height == picture.height)
      picture = split_picture(std::move(picture), truth, panel_.comparison.at);
  }
  // An EXR keeps the groups apart, for `wavepath relight`.
  if (display.mixes() && picture_format(path) != PictureFormat::exr) mix_groups(path, picture);
  request_.save(path, picture, display);
}

void Viewer::mix_groups(const std::string& path, Picture& picture) const {
  relight(path, panel_.settings.group_names, gains_of(panel_.settings, panel_.display), picture);
}

bool Viewer::compares() const {
  return (panel_.comparison.split || panel_.display.shown == Shown::shadow_error) &&
         supports(*panel_.settings.integrator, "shadows");
}

void Viewer::make_comparison() {
  verdict_ = {}, judged_spp_ = 0;
  scene_.compare(panel_.comparison.against);
}

// Once the render has the settings of the panel.
void Viewer::fit_comparison() {
  if (!compares()) {
    scene_.stop_comparing();
    verdict_ = {}, judged_spp_ = 0;
  } else if (!scene_.comparison() || scene_.comparison()->against() != panel_.comparison.against) {
    try {
      make_comparison();
    } catch (const Error& error) {
      panel_.message = error.what();
      panel_.comparison = {};
      if (panel_.display.shown == Shown::shadow_error) panel_.display.shown = Shown::color;
    }
  }
}

// At each half more samples than before: films are read back and judged on the host, which takes about as long as a few
// frames.
void Viewer::judge_shadows() {
  const std::uint32_t spp = scene_.comparison() ? scene_.comparison()->common_spp() : 0;
  if (spp == 0 || (judged_spp_ > 0 && 2 * spp < 3 * judged_spp_ && (spp == judged_spp_ || !done()))) return;
  verdict_ = scene_.comparison()->judge();
  judged_spp_ = spp;
}

void Viewer::draw_picture() {
  display_.draw(render_, panel_.display);
  if (!scene_.comparison()) return;
  if (panel_.display.shown == Shown::shadow_error) return display_.show(verdict_.map, panel_.display.bgra);
  if (splits())
    display_.draw(scene_.comparison()->truth(), panel_.display, split_column(panel_.comparison.at, display_.width()));
}

void Viewer::copy() {
  const std::string line = render_line(scene_.session().scene().path, camera_.request(), render_.settings(),
                                       panel_.display, request_.more_flags ? request_.more_flags() : std::string());
  glfwSetClipboardString(window_.handle(), line.c_str());
  try {
    print_out("{}\n", line);
    flush_out();
  } catch (const Error&) { // the clipboard has it
  }
  panel_.message = "copied: " + line;
}

// Chosen when a render that began anew has a sample of every pixel, and a few times more while it converges: at eight
// times the samples, and when it is done. While the camera moves it stays.
void Viewer::choose_exposure() {
  if (status_.spp < exposed_spp_ || status_.spp == 0) exposed_spp_ = 0;
  if (!panel_.display.auto_exposure || status_.spp == 0 || (exposed_ && status_.coarse > 1)) return;
  const bool due = status_.spp >= 8 * exposed_spp_ || (status_.done && status_.spp > exposed_spp_);
  if (!due) return;
  exposure_ = auto_exposure(render_.picture());
  if (!exposed_) panel_.display.exposure = exposure_;
  exposed_ = true;
  exposed_spp_ = status_.coarse > 1 ? 0 : status_.spp;
}

// Goes to the exposure without a jump.
void Viewer::adapt_exposure(double seconds) {
  double& shown = panel_.display.exposure;
  if (!panel_.display.auto_exposure || shown == exposure_) return;
  shown = exposure_ + (shown - exposure_) * std::exp(-std::max(seconds, 0.0) / kAdaption);
  if (scripted() || std::abs(shown - exposure_) < 0.01) shown = exposure_;
  redraws_ = std::max(redraws_, 1);
}

// Sets the window's title: the progress of the render, which task bars show for minimised windows as well.
void Viewer::show_title() {
  const char* state = done() ? ", done" : target_reached() ? ", target reached" : "";
  const std::string title = fmt::format("{} - {} spp{}", request_.title, status_.coarse > 1 ? 0 : status_.spp, state);
  if (title != title_) glfwSetWindowTitle(window_.handle(), title.c_str());
  title_ = title;
}

bool Viewer::target_reached() const {
  return panel_.target_error > 0.0 && status_.error_spp > 0 && status_.error.relative_rms <= panel_.target_error;
}

PanelFacts Viewer::facts() const {
  PanelFacts facts;
  const Scene& scene = scene_.session().scene();
  facts.scene = std::filesystem::path(scene.path).filename().string();
  facts.device = scene_.session().device_info().name;
  facts.status = status_;
  if (panel_.target_error > 0.0) facts.seconds_to_target = render_.seconds_to(panel_.target_error);
  for (const Camera& camera : scene.cameras) facts.cameras.push_back(camera.name.empty() ? "camera" : camera.name);
  facts.variants = scene.variants;
  if (request_.notes) facts.notes = request_.notes(render_.settings());
  for (const auto& [text, count] : scene.warnings.counts()) facts.notes.push_back(text);
  facts.score = verdict_.score;
  return facts;
}

} // namespace

std::vector<const char*> window_extensions() {
  open_glfw();
  std::uint32_t count = 0;
  const char** names = glfwGetRequiredInstanceExtensions(&count);
  if (!names)
    throw Error("view", "the driver cannot show pictures on this display",
                "use 'wavepath render', or a virtual display: xvfb-run -a wavepath view ...");
  return {names, names + count};
}

int run_window(ViewedScene& scene, const WindowRequest& request) { return Viewer(scene, request).run(); }

} // namespace wavepath
