#include "host/serve/server.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <deque>
#include <list>
#include <map>
#include <mutex>
#include <optional>
#include <string_view>
#include <thread>
#include <utility>

#include <fmt/format.h>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ip/v6_only.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "host/base/error.h"
#include "host/serve/access.h"

namespace wavepath {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using tcp = asio::ip::tcp;
using ErrorCode = beast::error_code;
using Clock = std::chrono::steady_clock;

constexpr std::uint32_t kLongestHeader = 8192; // bytes
constexpr double kFileSeconds = 600.0;         // that a file may take to its reader
constexpr std::size_t kUnreadNews = 4096;      // that the owner of the picture may leave before viewers are let go

std::chrono::nanoseconds duration_of(double seconds) {
  return std::chrono::nanoseconds(static_cast<std::int64_t>(seconds * 1e9));
}

std::string_view view_of(beast::string_view text) { return {text.data(), text.size()}; }

// So many a second, and twice as many at once.
class Allowance {
public:
  explicit Allowance(double rate) : rate_(rate), left_(2.0 * rate) {}
  bool take() {
    const Clock::time_point now = Clock::now();
    left_ = std::min(2.0 * rate_, left_ + rate_ * std::chrono::duration<double>(now - last_).count());
    last_ = now;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }
  double seconds_to_next() const { return std::max(0.0, (1.0 - left_) / rate_); }

private:
  double rate_, left_;
  Clock::time_point last_ = Clock::now();
};

struct NumberedFrame {
  std::uint32_t number = 0;
  std::string bytes;
};

class Viewer;
class Request;

// What connections share; used by the thread of the server alone, but for what `mutex` guards and what is atomic.
struct Hub {
  explicit Hub(const ServerRequest& wanted) : request(wanted), arrivals(wanted.limits.new_connections) {}

  void tell(ViewerNews news) {
    {
      const std::lock_guard lock(mutex);
      inbox.push_back(std::move(news));
    }
    arrived.notify_one();
  }
  bool is_full() {
    const std::lock_guard lock(mutex);
    return inbox.size() >= kUnreadNews;
  }
  void count_ready();

  const ServerRequest request;
  Allowance arrivals;
  std::size_t connections = 0;
  std::uint32_t last_id = 0;
  std::map<std::uint32_t, std::shared_ptr<Viewer>> viewers; // with the right token
  std::map<std::uint32_t, std::weak_ptr<Request>> files;    // that are waited for
  std::shared_ptr<const NumberedFrame> newest;
  std::atomic<std::size_t> ready{0}, present{0};
  bool ends = false;

  std::mutex mutex;
  std::condition_variable arrived;
  std::vector<ViewerNews> inbox;

  asio::io_context io{1}; // last, because what waits in it refers to the rest
};

// Counts itself among the connections while it lives.
class Counted {
public:
  explicit Counted(Hub& hub) : hub_(&hub) { ++hub_->connections; }
  Counted(Counted&& other) noexcept : hub_(std::exchange(other.hub_, nullptr)) {}
  ~Counted() {
    if (hub_) --hub_->connections;
  }

private:
  Hub* hub_;
};

// A viewer: a WebSocket that had to begin with the token.
class Viewer : public std::enable_shared_from_this<Viewer> {
public:
  Viewer(Hub& hub, beast::tcp_stream&& stream, Counted&& counted, std::uint32_t id)
      : hub_(hub),
        counted_(std::move(counted)),
        socket_(std::move(stream)),
        patience_(hub.io),
        id_(id),
        allowance_(hub.request.limits.messages) {}

  void accept(const http::request<http::empty_body>& request) {
    beast::get_lowest_layer(socket_).expires_never(); // the WebSocket has times of its own
    websocket::stream_base::timeout times{};
    times.handshake_timeout = duration_of(hub_.request.limits.handshake);
    times.idle_timeout = duration_of(hub_.request.limits.silence);
    times.keep_alive_pings = true;
    socket_.set_option(times);
    const bool asks = request.count(http::field::sec_websocket_protocol) > 0;
    socket_.set_option(websocket::stream_base::decorator([asks](websocket::response_type& response) {
      response.set(http::field::server, "wavepath");
      if (asks) response.set(http::field::sec_websocket_protocol, kProtocol);
    }));
    socket_.read_message_max(kLongestMessage);
    socket_.async_accept(request, [self = shared_from_this()](ErrorCode error) {
      if (error) return;
      self->wait_for_token();
      self->read();
    });
  }

  std::uint32_t id() const { return id_; }
  bool is_ready() const { return on_way_.size() < hub_.request.limits.frames_on_way; }

  void send(std::string text) {
    if (texts_.size() >= hub_.request.limits.unread_texts) return end(websocket::close_code::policy_error, "too slow");
    texts_.push_back(std::move(text));
    write();
  }
  void send_status(const std::string& text) {
    status_ = text;
    write();
  }

  // Sends what is due: answers, then the status, then the newest picture if the last ones were acknowledged.
  void write() {
    if (writing_ || ending_ || !is_in_) return;
    if (!texts_.empty()) {
      sent_ = std::move(texts_.front());
      texts_.pop_front();
      write(sent_, false);
    } else if (status_) {
      sent_ = std::move(*status_);
      status_.reset();
      write(sent_, false);
    } else if (is_ready() && hub_.newest && hub_.newest->number != last_frame_) {
      frame_ = hub_.newest;
      last_frame_ = frame_->number;
      if (on_way_.empty()) acknowledged_ = Clock::now();
      on_way_.push_back(last_frame_);
      hub_.count_ready();
      write(frame_->bytes, true);
    }
  }

  void end(websocket::close_code code, const char* why) {
    if (std::exchange(ending_, true)) return;
    leave();
    close_ = websocket::close_reason(code, why);
    if (!writing_) close();
  }

  // Without a word, as for one who has vanished.
  void drop() {
    ending_ = true;
    leave();
    beast::get_lowest_layer(socket_).close();
  }

private:
  void wait_for_token() {
    patience_.expires_after(duration_of(hub_.request.limits.handshake));
    patience_.async_wait([self = shared_from_this()](ErrorCode error) {
      if (!error && !self->is_in_) self->drop();
    });
  }

  void read() {
    socket_.async_read(buffer_, [self = shared_from_this()](ErrorCode error, std::size_t) { self->take(error); });
  }

  void take(ErrorCode error) {
    if (error) return drop();
    if (ending_) return;
    if (socket_.got_binary()) return end(websocket::close_code::unknown_data, "no binary messages");
    const std::string text = beast::buffers_to_string(buffer_.data());
    buffer_.consume(buffer_.size());
    const std::optional<Message> message = parse_message(text);
    if (!message || (message->kind != MessageKind::hello) != is_in_)
      return end(websocket::close_code::policy_error, "no such message");
    if (message->kind == MessageKind::hello) {
      if (!same_secret(message->value, hub_.request.token)) return refuse();
      join();
    } else if (message->kind == MessageKind::ack) {
      acknowledge(message->frame);
    } else {
      if (!allowance_.take()) return end(websocket::close_code::policy_error, "too many messages");
      if (hub_.is_full()) return end(websocket::close_code::try_again_later, "busy");
      hub_.tell({ViewerNews::Kind::message, id_, *message});
    }
    read();
  }

  // Whoever guesses does not learn at once that he was wrong.
  void refuse() {
    patience_.expires_after(duration_of(hub_.request.limits.wrong_token));
    patience_.async_wait([self = shared_from_this()](ErrorCode error) {
      if (!error) self->end(websocket::close_code::policy_error, "wrong token");
    });
  }

  void join() {
    is_in_ = true;
    patience_.cancel();
    hub_.viewers[id_] = shared_from_this();
    hub_.present = hub_.viewers.size();
    hub_.count_ready();
    hub_.tell({ViewerNews::Kind::joined, id_});
    watch();
    write();
  }

  // Pictures that nobody looks at are no use; whoever does so acknowledges.
  void watch() {
    const double silence = hub_.request.limits.silence;
    patience_.expires_after(duration_of(0.25 * silence));
    patience_.async_wait([self = shared_from_this(), silence](ErrorCode error) {
      if (error || self->ending_) return;
      if (!self->on_way_.empty() && Clock::now() - self->acknowledged_ > duration_of(silence)) return self->drop();
      self->watch();
    });
  }

  void acknowledge(std::uint32_t frame) {
    const auto found = std::ranges::find(on_way_, frame);
    if (found == on_way_.end()) {
      if (!allowance_.take()) end(websocket::close_code::policy_error, "too many messages");
      return;
    }
    on_way_.erase(on_way_.begin(), found + 1);
    acknowledged_ = Clock::now();
    hub_.count_ready();
    hub_.arrived.notify_one(); // the owner may want to make another one
    write();
  }

  void write(const std::string& bytes, bool binary) {
    writing_ = true;
    socket_.binary(binary);
    socket_.async_write(asio::buffer(bytes), [self = shared_from_this()](ErrorCode error, std::size_t) {
      self->writing_ = false;
      self->frame_.reset();
      if (error) return self->drop();
      if (self->ending_) return self->close();
      self->write();
    });
  }

  void close() {
    socket_.async_close(close_, [self = shared_from_this()](ErrorCode) { self->drop(); });
  }

  void leave() {
    patience_.cancel();
    if (!std::exchange(is_in_, false)) return;
    hub_.viewers.erase(id_);
    hub_.present = hub_.viewers.size();
    hub_.count_ready();
    hub_.tell({ViewerNews::Kind::left, id_});
  }

  Hub& hub_;
  Counted counted_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_{kLongestMessage};
  asio::steady_timer patience_;
  std::uint32_t id_;
  Allowance allowance_;
  bool is_in_ = false, writing_ = false, ending_ = false;
  websocket::close_reason close_;
  std::string sent_; // that is being written
  std::shared_ptr<const NumberedFrame> frame_;
  std::deque<std::string> texts_;
  std::optional<std::string> status_;
  std::deque<std::uint32_t> on_way_;
  std::uint32_t last_frame_ = 0;
  Clock::time_point acknowledged_ = Clock::now();
};

// A request by HTTP: one a connection.
class Request : public std::enable_shared_from_this<Request> {
public:
  Request(Hub& hub, tcp::socket&& socket)
      : hub_(hub), counted_(hub), stream_(std::move(socket)), pause_(hub.io), id_(++hub.last_id) {}

  void read() {
    parser_.header_limit(kLongestHeader);
    stream_.expires_after(duration_of(hub_.request.limits.handshake));
    http::async_read_header(stream_, buffer_, parser_, [self = shared_from_this()](ErrorCode error, std::size_t) {
      if (error == http::error::header_limit)
        self->refuse(http::status::request_header_fields_too_large, "the request is too long");
      else if (!error)
        self->answer();
      else if (error != http::error::end_of_stream &&
               error.category() == http::make_error_code(http::error::end_of_stream).category())
        self->refuse(http::status::bad_request, "this is no request of HTTP");
    });
  }

  void send_file(const std::string& name, std::string bytes) {
    const bool is_png = name.ends_with(".png");
    Response response = make(http::status::ok, is_png ? "image/png" : "image/x-exr", std::move(bytes));
    response.set(http::field::content_disposition, fmt::format("attachment; filename=\"{}\"", name));
    write(std::move(response), kFileSeconds);
  }

  void refuse(http::status status, const std::string& why) { write(make(status, "text/plain", why + "\n"), 10.0); }

  void drop() { stream_.close(); }

private:
  using Response = http::response<http::string_body>;

  std::string_view header(http::field field) const { return view_of(parser_.get()[field]); }

  void answer() {
    const auto& request = parser_.get();
    const std::vector<std::string>& hosts = hub_.request.hosts;
    const std::string_view origin = header(http::field::origin);
    if (request.count(http::field::host) != 1 || !is_allowed_host(header(http::field::host), hosts))
      return refuse(http::status::forbidden, "this host is not served; see --allow-host");
    if (request.count(http::field::origin) > 1 || (!origin.empty() && !is_allowed_origin(origin, hosts)))
      return refuse(http::status::forbidden, "pages of other hosts are not served; see --allow-host");
    if (request.method() != http::verb::get && request.method() != http::verb::head) {
      Response response = make(http::status::method_not_allowed, "text/plain", "GET and HEAD only\n");
      response.set(http::field::allow, "GET, HEAD");
      return write(std::move(response), 10.0);
    }
    const std::string_view target = view_of(request.target());
    if (target == "/session" && websocket::is_upgrade(request)) return upgrade();
    if (target == "/session") return refuse(http::status::upgrade_required, "this is a WebSocket");
    if (target == "/") return send_page();
    if (target == "/favicon.ico") return write(make(http::status::no_content, "text/plain", ""), 10.0);
    if (target == "/picture.exr" || target == "/picture.png") return ask_for_file(std::string(target.substr(9)));
    refuse(http::status::not_found, "there is nothing of this name");
  }

  void upgrade() {
    std::make_shared<Viewer>(hub_, std::move(stream_), std::move(counted_), id_)->accept(parser_.get());
  }

  void send_page() {
    Response response = make(http::status::ok, "text/html; charset=utf-8", hub_.request.page);
    response.set("Content-Security-Policy", hub_.request.content_policy);
    write(std::move(response), 30.0);
  }

  void ask_for_file(std::string format) {
    constexpr std::string_view kBearer = "Bearer ";
    const std::string_view given = header(http::field::authorization);
    if (!given.starts_with(kBearer) || !same_secret(given.substr(kBearer.size()), hub_.request.token)) {
      stream_.expires_never();
      pause_.expires_after(duration_of(hub_.request.limits.wrong_token));
      return pause_.async_wait(
          [self = shared_from_this()](ErrorCode) { self->refuse(http::status::unauthorized, "wrong token"); });
    }
    if (hub_.is_full()) return refuse(http::status::service_unavailable, "busy");
    stream_.expires_never();
    hub_.files[id_] = weak_from_this();
    hub_.tell({ViewerNews::Kind::wants_file, id_, {}, std::move(format)});
    pause_.expires_after(duration_of(kFileSeconds)); // keeps the connection until then
    pause_.async_wait([self = shared_from_this()](ErrorCode) {});
  }

  Response make(http::status status, const char* type, std::string body) const {
    Response response(status, 11, std::move(body));
    response.set(http::field::server, "wavepath");
    response.set(http::field::content_type, type);
    response.set(http::field::cache_control, "no-store");
    response.set("X-Content-Type-Options", "nosniff");
    response.set("Referrer-Policy", "no-referrer");
    response.set("Cross-Origin-Resource-Policy", "same-origin");
    response.keep_alive(false);
    return response;
  }

  void write(Response response, double seconds) {
    pause_.cancel();
    response_ = std::move(response);
    response_.prepare_payload();
    stream_.expires_after(duration_of(seconds));
    const auto then = [self = shared_from_this()](ErrorCode error, std::size_t) {
      ErrorCode ignored;
      if (!error) self->stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
    };
    if (parser_.get().method() == http::verb::head) {
      serializer_.emplace(response_);
      http::async_write_header(stream_, *serializer_, then);
    } else {
      http::async_write(stream_, response_, then);
    }
  }

  Hub& hub_;
  Counted counted_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{2 * kLongestHeader};
  http::request_parser<http::empty_body> parser_;
  Response response_;
  std::optional<http::response_serializer<http::string_body>> serializer_;
  asio::steady_timer pause_;
  std::uint32_t id_;
};

void Hub::count_ready() {
  std::size_t count = 0;
  for (const auto& [id, viewer] : viewers) count += viewer->is_ready() ? 1 : 0;
  ready = count;
}

// Lets connections in, no more at once and no faster than is allowed.
class Listener {
public:
  Listener(Hub& hub, const tcp::endpoint& endpoint) : hub_(hub), acceptor_(hub.io), pause_(hub.io) {
    acceptor_.open(endpoint.protocol());
    acceptor_.set_option(asio::socket_base::reuse_address(true));
    if (endpoint.address().is_v6()) acceptor_.set_option(asio::ip::v6_only(true));
    acceptor_.bind(endpoint);
    acceptor_.listen();
  }

  std::uint16_t port() const { return acceptor_.local_endpoint().port(); }

  void listen() {
    if (hub_.ends) return;
    if (!hub_.arrivals.take()) return wait(hub_.arrivals.seconds_to_next());
    acceptor_.async_accept([this](ErrorCode error, tcp::socket socket) {
      if (hub_.ends) return;
      if (error) return wait(0.1); // as when there are no descriptors left
      if (hub_.connections < hub_.request.limits.connections)
        std::make_shared<Request>(hub_, std::move(socket))->read();
      listen();
    });
  }

  void close() {
    ErrorCode ignored;
    acceptor_.close(ignored);
    pause_.cancel();
  }

private:
  void wait(double seconds) {
    pause_.expires_after(duration_of(seconds));
    pause_.async_wait([this](ErrorCode) { listen(); });
  }

  Hub& hub_;
  tcp::acceptor acceptor_;
  asio::steady_timer pause_;
};

} // namespace

struct Server::Inside {
  explicit Inside(const ServerRequest& request) : hub(request) {
    ErrorCode wrong;
    const asio::ip::address address = asio::ip::make_address(request.address, wrong);
    if (wrong) throw UsageError("--listen " + request.address, "is no address", "give one in digits, as 127.0.0.1");
    try {
      port = listeners.emplace_back(hub, tcp::endpoint(address, request.port)).port();
    } catch (const boost::system::system_error& error) {
      throw Error(fmt::format("{}:{}", request.address, request.port),
                  fmt::format("cannot be listened to ({})", error.code().message()),
                  "give another --port, or 0 for one that is free");
    }
    // Nobody else of this machine is to answer there for "localhost".
    if (request.address == "127.0.0.1") try {
        listeners.emplace_back(hub, tcp::endpoint(asio::ip::address_v6::loopback(), port));
      } catch (const boost::system::system_error&) { // a machine without IPv6
      }
    for (Listener& listener : listeners) listener.listen();
    thread = std::thread([this] { hub.io.run(); });
  }

  ~Inside() {
    asio::post(hub.io, [this] {
      hub.ends = true;
      for (Listener& listener : listeners) listener.close();
      hub.io.stop();
    });
    thread.join();
    hub.viewers.clear();
  }

  Hub hub;
  std::list<Listener> listeners;
  std::uint16_t port = 0;
  std::thread thread;
};

Server::Server(const ServerRequest& request) : inside_(std::make_unique<Inside>(request)) {}

Server::~Server() = default;

std::uint16_t Server::port() const { return inside_->port; }

std::vector<ViewerNews> Server::take(double seconds) {
  Hub& hub = inside_->hub;
  std::unique_lock lock(hub.mutex);
  if (hub.inbox.empty() && seconds > 0.0) hub.arrived.wait_for(lock, duration_of(seconds));
  return std::exchange(hub.inbox, {});
}

std::size_t Server::viewers() const { return inside_->hub.present; }

bool Server::wants_frame() const { return inside_->hub.ready > 0; }

void Server::send(std::uint32_t viewer, std::string text) {
  Hub& hub = inside_->hub;
  asio::post(hub.io, [&hub, viewer, text = std::move(text)]() mutable {
    const auto found = hub.viewers.find(viewer);
    if (found != hub.viewers.end()) std::shared_ptr(found->second)->send(std::move(text));
  });
}

void Server::send_to_all(std::string text) {
  Hub& hub = inside_->hub;
  asio::post(hub.io, [&hub, text = std::move(text)] {
    const auto all = hub.viewers; // one that is too slow leaves
    for (const auto& [id, viewer] : all) viewer->send(text);
  });
}

void Server::send_status(std::string text) {
  Hub& hub = inside_->hub;
  asio::post(hub.io, [&hub, text = std::move(text)] {
    for (const auto& [id, viewer] : hub.viewers) viewer->send_status(text);
  });
}

void Server::show(std::uint32_t number, std::string bytes) {
  Hub& hub = inside_->hub;
  auto frame = std::make_shared<const NumberedFrame>(NumberedFrame{number, std::move(bytes)});
  asio::post(hub.io, [&hub, frame = std::move(frame)]() mutable {
    if (hub.newest && hub.newest->number > frame->number) return; // it was overtaken
    hub.newest = std::move(frame);
    for (const auto& [id, viewer] : hub.viewers) viewer->write();
  });
}

void Server::answer_file(std::uint32_t request, const std::string& name, std::string bytes) {
  Hub& hub = inside_->hub;
  asio::post(hub.io, [&hub, request, name, bytes = std::move(bytes)]() mutable {
    if (const auto waiting = hub.files[request].lock()) waiting->send_file(name, std::move(bytes));
    hub.files.erase(request);
  });
}

void Server::refuse_file(std::uint32_t request, const std::string& why) {
  Hub& hub = inside_->hub;
  asio::post(hub.io, [&hub, request, why] {
    if (const auto waiting = hub.files[request].lock()) waiting->refuse(http::status::service_unavailable, why);
    hub.files.erase(request);
  });
}

} // namespace wavepath
