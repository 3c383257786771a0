// wavepath serve: the window in a browser, for machines without a display.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/base/error.h"
#include "host/base/print.h"
#include "host/cli/commands.h"
#include "host/cli/flags.h"
#include "host/cli/interrupt.h"
#include "host/cli/render_flags.h"
#include "host/cli/viewing.h"
#include "host/render/progressive/display.h"
#include "host/serve/access.h"
#include "host/serve/page.h"
#include "host/serve/server.h"
#include "host/serve/serving.h"

namespace wavepath {
namespace {

constexpr std::uint16_t kUsualPort = 8740;

struct ServeCommandRequest {
  ViewingRequest viewing;
  std::string address = "127.0.0.1";
  std::uint32_t port = kUsualPort;
  std::vector<std::string> hosts;
};

std::string in_brackets(const std::string& address) {
  return address.find(':') == std::string::npos ? address : "[" + address + "]";
}

int run_serve(ServeCommandRequest& request) {
  if (request.viewing.shown == Shown::shadow_error)
    throw UsageError("--show shadow-error", "needs a comparison, which the page does not offer", "use wavepath view");
  check_viewing(request.viewing);
  ServerRequest wanted;
  wanted.address = request.address;
  wanted.port = static_cast<std::uint16_t>(request.port);
  wanted.hosts = request.hosts;
  // Digits, to which no foreign name server gives a meaning; but not those that stand for any address.
  if (request.address != "0.0.0.0" && request.address != "::") wanted.hosts.push_back(in_brackets(request.address));
  wanted.token = make_token();
  wanted.page = kServedPage;
  wanted.content_policy = served_page_policy();
  Server server(wanted); // first: a port that cannot be had is told before the scene is loaded
  if (!is_loopback(in_brackets(request.address)))
    print_err(
        "wavepath: warning: --listen {}: pictures, settings and the token go over the network without encryption; "
        "prefer ssh -L {}:127.0.0.1:{} THIS-MACHINE, without --listen\n",
        request.address, server.port(), server.port());

  Viewing viewing(request.viewing);
  ServingRequest serving;
  serving.framing = viewing.framing();
  serving.more_flags = [&] { return viewing.flags(); };
  serving.display = first_display(request.viewing);
  serving.target_error = request.viewing.render.settings.target_error;
  serving.notes = [&](const RenderPlan& settings) { return viewing.notes(settings); };
  serving.plan = [&](const RenderPlan& settings) { return viewing.decisions(settings); };
  serving.save = [&](const std::string& path, const Picture& picture, const DisplayOptions& display) {
    viewing.save(path, picture, display);
  };
  serving.ends = interrupted;
  catch_interrupts();
  print_out("http://{}:{}/#{}\n", in_brackets(request.address), server.port(), wanted.token);
  flush_out();
  print_err("wavepath: open this address in a browser; Ctrl-C ends\n");
  serve_scene(viewing.scene(), server, serving);
  viewing.save_kernels();
  return kExitDone;
}

void add_server_flags(CLI::App& app, ServeCommandRequest& request) {
  const char* group = "Server";
  static constexpr HelpOverride kHelpOverrides[] = {
      {"spp", "samples per pixel at which rendering ends", "65536", kMostViewedSamples},
      {"target-error",
       "estimated relative RMS error to reach; 0.01 is 1 %. The page shows the remaining time, and rendering stops "
       "there"}};
  add_settings(app, kByView, SettingGroup::stop, request.viewing.render, kHelpOverrides, group);
  add_flag(app, group, {"--port", "N", "port of the page; 0 = one that is free", fmt::format("{}", kUsualPort)},
           [&](const FlagValue& value) { request.port = value.whole_number(0, 65535); });
  add_flag(app, group,
           {"--listen", "ADDRESS",
            "address of this machine to answer at, in digits. Anything but the default lets others on the network try, "
            "and nothing is encrypted",
            "127.0.0.1"},
           [&](const FlagValue& value) { request.address = value.text; });
  add_flag(
      app, group,
      {"--allow-host", "NAME", "name of this machine by which browsers may ask for the page; repeatable", "localhost"},
      [&](const FlagValue& value) {
        const std::string name = host_name(value.text);
        if (name.empty())
          throw UsageError("--allow-host " + value.text, "is no name of a host", "give one without http://");
        request.hosts.push_back(name);
      },
      true);
  add_show_flag(app, group,
                "first display: color, albedo, normal, depth, position, direct, indirect, emission, samples, variance, "
                "error, ao (hybrid only), roughness, metallic, triangles, instances or materials",
                request.viewing);
}

} // namespace

Command add_serve(CLI::App& app, const std::string& command_line) {
  CLI::App* command = add_command(app, "serve", "render a scene in a browser");
  const auto request = std::make_shared<ServeCommandRequest>();
  request->viewing.command_line = command_line;
  add_server_flags(*command, *request);
  add_viewing_flags(*command, "Server", request->viewing);
  return [request] { return run_serve(*request); };
}

} // namespace wavepath
