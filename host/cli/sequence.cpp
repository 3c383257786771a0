// Poses, packs, plans, renders and writes one frame after another; see sequence.h.
#include "host/cli/sequence.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <future>
#include <memory>
#include <string_view>
#include <system_error>

#include <fmt/format.h>
#include <glm/gtc/matrix_transform.hpp>
#include <nlohmann/json.hpp>

#include "host/base/atomic_file.h"
#include "host/base/clock.h"
#include "host/base/error.h"
#include "host/base/output_files.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/interrupt.h"
#include "host/cli/progress.h"
#include "host/cli/render_finish.h"
#include "host/cli/render_run.h"
#include "host/plan/record.h"
#include "host/render/pilot_work.h"
#include "host/render/settings/pass_names.h"
#include "host/scene/bounds.h"
#include "host/session/resume.h"

namespace wavepath {
namespace {

// Frames that share a plan: pilots are made for those whose number is a multiple of this. A plan that went by the range
// would give a frame other bits on another machine; one for each frame would cost its pilots each time.
constexpr std::uint32_t kFramesOfPlan = 16;

std::string default_name(const RenderCommandRequest& request) {
  const bool many = request.sequence.frames->count() > 1;
  return std::filesystem::path(request.scene.path).stem().string() + (many ? ".####.exr" : ".exr");
}

// The command that renders the frame alone, but for its camera, and what the staged scene decides.
RenderCommandRequest request_of(const RenderCommandRequest& whole, std::uint32_t frame) {
  RenderCommandRequest one = whole;
  const SequenceRequest& sequence = whole.sequence;
  for (std::string& name : one.output.pictures) name = numbered(name, frame);
  for (std::string* name : {&one.output.stats, &one.output.reference, &one.render.state.file})
    *name = numbered(*name, frame);
  one.render.settings.seed = seed_of(sequence, whole.render.settings.seed, frame);
  LoadOptions& load = one.scene.load;
  if (!load.animation.empty()) {
    const double later = seconds_of(sequence, frame);
    load.at += later;
    if (load.shutter)
      load.shutter = {whole.scene.load.at + load.shutter->first + later,
                      whole.scene.load.at + load.shutter->second + later};
  }
  return one;
}

// Every file of every frame is told from the others and from what is read, and can be written.
void check_names(const RenderCommandRequest& whole) {
  const FrameRange& range = *whole.sequence.frames;
  const std::vector<std::string> patterns = targets_of(whole);
  for (const std::string& name : patterns)
    if (range.count() > 1 && !has_number(name))
      throw UsageError(name, fmt::format("is one name for {} frames", range.count()),
                       "put a place for the number into it, such as film.%04d.exr or film.####.exr");
  std::vector<std::string> all;
  for (std::uint32_t frame = range.first; frame < range.end; frame += range.step)
    for (const std::string& name : patterns) all.push_back(numbered(name, frame));
  refuse_overwriting(all, inputs_of(whole.scene, whole.render.settings, whole.output.reference));
}

// A frame is there once all its files are; its state is none of them.
bool is_there(const RenderCommandRequest& one) {
  std::vector<std::string> files = one.output.pictures;
  if (!one.output.stats.empty()) files.push_back(one.output.stats);
  std::error_code error;
  return std::ranges::all_of(files, [&](const std::string& file) { return std::filesystem::exists(file, error); });
}

// The frames that are to be rendered.
std::vector<std::uint32_t> list_frames(const RenderCommandRequest& whole) {
  const FrameRange& range = *whole.sequence.frames;
  std::vector<std::uint32_t> frames;
  for (std::uint32_t frame = range.first; frame < range.end; frame += range.step) {
    const RenderCommandRequest one = request_of(whole, frame);
    if (!whole.sequence.overwrites && is_there(one)) continue;
    check_state_file(one.render.state);
    for (const std::string& target : targets_of(one)) require_writable(target);
    frames.push_back(frame);
  }
  return frames;
}

// The camera, gone about the vertical axis through `centre`.
ViewRequest turned(const ViewRequest& request, const View& view, const glm::dvec3& centre, double degrees) {
  const glm::dmat3 turn(glm::rotate(glm::dmat4(1.0), glm::radians(degrees), glm::dvec3(0.0, 1.0, 0.0)));
  const double distance = std::max(glm::length(centre - view.position), 1e-3);
  ViewRequest gone = request;
  gone.eye = centre + turn * (view.position - centre);
  gone.look_at = *gone.eye + turn * view.forward * distance;
  gone.up = turn * glm::normalize(view.up);
  return gone;
}

// What is kept from frame to frame.
class Sequence {
public:
  Sequence(const RenderCommandRequest& whole, const std::vector<std::uint32_t>& frames)
      : whole_(whole),
        frames_(frames),
        progress_(whole.output.quiet, whole.render.settings.time_limit, whole.render.settings.target_error) {}

  int run();

private:
  void open(const RenderCommandRequest& first);
  void prepare(RenderCommandRequest& one, std::uint32_t frame);
  void pose(RenderCommandRequest& one, std::uint32_t frame);
  void pose_moment(const LoadOptions& load);
  ViewRequest turned_view(double frame) const;
  void plan(RenderCommandRequest& one, std::uint32_t frame);
  void keep_new_warnings();
  void write_meanwhile(std::unique_ptr<Unwritten> ended);
  void tell_written();

  const RenderCommandRequest& whole_;
  const std::vector<std::uint32_t>& frames_;
  ProgressDisplay progress_;
  std::unique_ptr<Session> session_;
  std::optional<double> staged_at_;
  glm::dvec3 origin_{0.0}, centre_{0.0};
  std::optional<PlanRecord> plan_;
  std::uint32_t planned_frame_ = 0; // that plan_ was made for
  Warnings told_;
  // The frame whose files are written while the next one is rendered; null = none.
  std::unique_ptr<Unwritten> unwritten_;
  std::future<void> writing_;
  std::exception_ptr failure_; // of a report while the next frame was rendered
  std::size_t done_ = 0;       // frames whose files are there
  int code_ = kExitDone;
};

// Loads the scene as frame 0 shows it. That decides what must not jump from frame to frame: framing, default light,
// ground, the axis of the turntable, and the origin, to which all geometry is moved.
void Sequence::open(const RenderCommandRequest& first) {
  RenderCommandRequest staged = first;
  const bool animated = !whole_.scene.load.animation.empty();
  if (animated) {
    staged_at_ = whole_.scene.staged_at.value_or(whole_.scene.load.at);
    staged.scene.load.at = *staged_at_;
    staged.scene.load.shutter.reset();
  }
  staged.scene.staged_at.reset();
  session_ = open_session(staged, SessionUse::poses);
  const LoadedScene& loaded = session_->loaded();
  std::vector<std::string> targets;
  for (const std::uint32_t frame : frames_)
    for (const std::string& target : targets_of(request_of(whole_, frame))) targets.push_back(target);
  refuse_overwriting(targets, loaded.scene.files);
  const RenderPlan& settings = first.render.settings;
  const View view = resolve_view(loaded.scene, loaded.framing, whole_.scene.view, settings.width, settings.height);
  const Bounds bounds = world_bounds(loaded.scene);
  centre_ = bounds.empty() ? glm::dvec3(0.0) : bounds.centre();
  // The middle, which lies within the bounds of other poses as well, where the eye does not.
  const bool inside = !bounds.empty() && glm::all(glm::lessThanEqual(bounds.lo, view.position)) &&
                      glm::all(glm::lessThanEqual(view.position, bounds.hi));
  origin_ = whole_.render.origin.value_or(inside ? view.position : centre_);
  session_->set_origin(origin_);
}

void Sequence::pose_moment(const LoadOptions& load) {
  session_->set_moment(load.at, load.shutter);
  session_->pose();
}

// Camera of a frame, at whose moment the scene stands.
ViewRequest Sequence::turned_view(double frame) const {
  if (!whole_.sequence.turntable) return whole_.scene.view;
  const RenderPlan& settings = whole_.render.settings;
  const LoadedScene& loaded = session_->loaded();
  const View view = resolve_view(loaded.scene, loaded.framing, whole_.scene.view, settings.width, settings.height);
  return turned(whole_.scene.view, view, centre_, turned_by(whole_.sequence, frame));
}

// Poses the scene at the frame's moment. The frames beside it become the other pictures of motion passes; those before
// the first and after the last one exist as well, for an animation that is held there.
void Sequence::pose(RenderCommandRequest& one, std::uint32_t frame) {
  const LoadOptions& load = one.scene.load;
  session_->set_motion({});
  const auto find = [&](std::string_view pass, double step, OtherMoment& other) {
    if (std::ranges::count(one.render.settings.aovs, pass) == 0) return;
    if (!load.animation.empty()) {
      LoadOptions there = load;
      there.at = (load.shutter ? load.shutter->first : load.at) + seconds_of(whole_.sequence, step);
      there.shutter.reset();
      other.at = there.at;
      if (whole_.sequence.turntable) pose_moment(there);
    }
    if (!whole_.sequence.turntable) return;
    const ViewRequest view = turned_view(frame + step);
    other.camera = OtherCamera{.eye = *view.eye, .look_at = *view.look_at, .up = view.up};
  };
  find(kMotionPass, 1.0, one.motion.next);
  find(kMotionBackPass, -1.0, one.motion.previous);
  pose_moment(load);
  one.scene.view = turned_view(frame);
  session_->set_view(one.scene.view);
  session_->set_motion(one.motion);
  session_->pose();
}

// Poses and packs the scene, and brings it onto the device. `one` becomes the whole command of the frame.
void Sequence::prepare(RenderCommandRequest& one, std::uint32_t frame) {
  const Clock::time_point start = Clock::now();
  if (staged_at_ && *staged_at_ != one.scene.load.at) one.scene.staged_at = staged_at_;
  if (one.scene.load.shutter) one.scene.staged_at = staged_at_;
  one.render.origin = origin_;
  pose(one, frame);
  const double pose_seconds = seconds_since(start);
  Prepared& prepared = session_->prepared();
  prepared.packed.bvh_seconds = 0.0; // of another frame
  const SessionUpdate update = session_->update(one.render);
  double pack_seconds = 0.0;
  for (const Redone& part : update.redone)
    if (part.what == std::string_view("pack")) pack_seconds += 1e-3 * part.milliseconds;
  prepared.load_seconds = pose_seconds + pack_seconds - prepared.packed.bvh_seconds;
  one.frame = FrameReport{.number = frame,
                          .at = one.scene.load.at,
                          .fps = whole_.sequence.fps.value_or(kUsualFps),
                          .turned = turned_by(whole_.sequence, frame),
                          .pose_seconds = pose_seconds,
                          .pack_seconds = pack_seconds,
                          .kept_surfaces = update.kept_surfaces,
                          .kept_geometry = update.kept_geometry,
                          .built_triangles = update.built_triangles};
}

// Takes the plan of the first frame of its sixteen, which is made by that frame wherever it is not rendered here.
void Sequence::plan(RenderCommandRequest& one, std::uint32_t frame) {
  const std::uint32_t decisive = frame - frame % kFramesOfPlan;
  const DeviceClass device = class_of(session_->prepared().device->info());
  const bool decides = one.render.recorded || decisive == frame || !may_make_pilots(one.render.settings, device);
  if (!decides && (!plan_ || planned_frame_ != decisive)) {
    const RenderCommandRequest pattern = request_of(whole_, decisive);
    RenderCommandRequest other = one;
    other.scene = pattern.scene;
    other.render.settings.seed = pattern.render.settings.seed;
    other.render.state = {};
    prepare(other, decisive);
    plan_render(other, session_->prepared());
    plan_ = record_from(nlohmann::ordered_json::parse(to_line(session_->prepared().plan.decisions)));
    planned_frame_ = decisive;
    prepare(one, frame);
  }
  if (!decides) one.render.recorded = plan_;
  plan_render(one, session_->prepared());
  if (decisive == frame) {
    plan_ = record_from(nlohmann::ordered_json::parse(to_line(session_->prepared().plan.decisions)));
    planned_frame_ = decisive;
  }
}

// What an earlier frame has warned of is not told again.
void Sequence::keep_new_warnings() {
  Warnings fresh;
  for (const auto& [text, count] : session_->prepared().warnings.counts())
    if (!told_.counts().contains(text)) fresh.add(text, count), told_.add(text, count);
  session_->prepared().warnings = fresh;
}

// Files appear in the order of the frames: there is one frame at a time that waits for its own.
void Sequence::write_meanwhile(std::unique_ptr<Unwritten> ended) {
  tell_written();
  unwritten_ = std::move(ended);
  try {
    writing_ = std::async(std::launch::async, [this] { write(*unwritten_); });
  } catch (const std::system_error&) { // no thread can be had
    write(*unwritten_);
  }
}

// Waits for the files, if any are being written, and reports them. Throws Error where they could not be.
void Sequence::tell_written() {
  if (!unwritten_) return;
  if (writing_.valid()) writing_.get();
  const std::unique_ptr<Unwritten> written = std::move(unwritten_);
  progress_.clear();
  code_ = std::max(code_, tell(*written));
  ++done_;
}

int Sequence::run() {
  const Clock::time_point start = Clock::now();
  double render_seconds = 0.0;
  std::size_t begun = 0;
  progress_.call_meanwhile([this] {
    const bool ready = writing_.valid() && writing_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    if (ready) try {
        tell_written();
      } catch (...) { // ends the film, but not from within the render
        failure_ = std::current_exception();
      }
  });
  for (const std::uint32_t frame : frames_) {
    RenderCommandRequest one = request_of(whole_, frame);
    one.progress = &progress_;
    const std::optional<Picture> reference = resolve(one);
    if (begun == 0) open(one);
    prepare(one, frame);
    if (begun == 0) require_writers(one.output);
    plan(one, frame);
    if (interrupted()) break;
    progress_.begin_frame({frame, begun, frames_.size()});
    Rendered rendered = wavepath::run(one, session_->prepared(), reference, {});
    if (failure_) std::rethrow_exception(failure_);
    const StopReason stop = rendered.result.stop;
    if (stop == StopReason::interrupted) break;
    if (stop == StopReason::device_lost) // what it has would be taken for the frame
      throw DeviceLost(session_->prepared().device->info().name,
                       fmt::format("was lost while rendering frame {}", frame),
                       "run the same command to go on with that frame");
    render_seconds += rendered.result.seconds;
    keep_new_warnings();
    ++begun;
    if (one.output.verbose || session_->prepared().viewer) { // which need the scene, or the picture at once
      code_ = std::max(code_, finish(one, session_->prepared(), rendered, reference));
      ++done_;
    } else {
      write_meanwhile(end_render(one, session_->prepared(), rendered, reference));
    }
  }
  tell_written();
  const std::size_t all = whole_.sequence.frames->count();
  if (interrupted() && done_ < frames_.size()) {
    if (!whole_.output.quiet)
      print_err("wavepath: interrupted in frame {}; the same command goes on there\n", frames_[done_]);
    return kExitInterrupted;
  }
  if (!whole_.output.quiet)
    print_err("wavepath: {} frames in {}, {} of that rendering; {} were there\n", done_,
              duration_text(seconds_since(start)), duration_text(render_seconds), all - frames_.size());
  return code_;
}

} // namespace

int render_sequence(const RenderCommandRequest& request) {
  RenderCommandRequest whole = request;
  if (whole.output.pictures.empty()) whole.output.pictures = {default_name(whole)};
  if (whole.render.pixel)
    throw UsageError("--pixel", "renders one path of one picture", "use the command that `repeat` of a frame tells");
  if (whole.output.save_every > 0.0)
    throw UsageError("--save-every", "goes with one picture: one of a part of the samples would be taken for a frame",
                     "leave it out");
  check_names(whole);
  const std::vector<std::uint32_t> frames = list_frames(whole);
  if (frames.empty()) {
    if (!whole.output.quiet)
      print_err("wavepath: all {} frames are there; --overwrite renders them again\n", whole.sequence.frames->count());
    return kExitDone;
  }
  return Sequence(whole, frames).run();
}

} // namespace wavepath
