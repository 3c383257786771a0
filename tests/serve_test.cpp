// The server of `wavepath serve`: whom it answers, what it bears, and that its pictures are those of `wavepath render`.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/base/error.h"
#include "host/codecs/decode.h"
#include "host/serve/access.h"
#include "host/serve/frame.h"
#include "host/serve/message.h"
#include "host/serve/page.h"
#include "host/serve/server.h"
#include "tests/run_wavepath.h"
#include "tests/temporary_folder.h"
#include "tests/vulkan_device.h"
#include "tests/web_client.h"

namespace wavepath::test {
namespace {

using Json = nlohmann::json;

const std::string kCornell = WAVEPATH_SOURCE_DIR "/scenes/cornell_box.gltf";

TEST(ServeAccess, HostsOfThisMachineAreAnswered) {
  const std::vector<std::string> others = {"render.example.org", "[fd00::1]"};
  for (const char* host : {"localhost", "LOCALHOST:8740", "127.0.0.1", "127.0.0.1:1", "127.1.2.3:80", "[::1]",
                           "[::1]:8740", "render.example.org", "Render.Example.Org:443", "[fd00::1]:8740"})
    EXPECT_TRUE(is_allowed_host(host, others)) << host;
  for (const char* host :
       {"", ":8740", "example.org", "localhost.example.org", "127.0.0.1.example.org", "127.0.0.1.", "127.0.0", "[::1",
        "[::1]x", "[::2]", "localhost:", "localhost:8740x", "localhost:80:80", "evil@localhost", "localhost/",
        "0.0.0.0", "127.0.0.1 example.org", "render.example.org.evil.net", "xrender.example.org"})
    EXPECT_FALSE(is_allowed_host(host, others)) << host;
}

TEST(ServeAccess, OriginsAreThoseOfTheSameHosts) {
  for (const char* origin : {"http://localhost:8740", "http://127.0.0.1", "https://[::1]:1"})
    EXPECT_TRUE(is_allowed_origin(origin, {})) << origin;
  for (const char* origin : {"null", "", "localhost", "http://example.org", "http://localhost.example.org",
                             "file://localhost", "http://", "http://localhost@example.org"})
    EXPECT_FALSE(is_allowed_origin(origin, {})) << origin;
}

TEST(ServeAccess, TokensAre256BitsAndComparedWhole) {
  const std::string token = make_token();
  EXPECT_EQ(token.size(), 64u);
  EXPECT_NE(token, make_token());
  EXPECT_TRUE(same_secret(token, token));
  EXPECT_FALSE(same_secret("", token));
  EXPECT_FALSE(same_secret(token.substr(1), token));
  EXPECT_FALSE(same_secret(token + token, token));
  EXPECT_FALSE(same_secret("", ""));
  std::string other = token;
  other.back() = other.back() == '0' ? '1' : '0';
  EXPECT_FALSE(same_secret(other, token));
}

const char* const kMessages[] = {
    R"({"type":"hello","token":"00ff"})",
    R"({"type":"ack","frame":7})",
    R"({"type":"take"})",
    R"({"type":"steer","left":[0.1,-0.2],"fly":[0,0,1],"seconds":0.02,"dragging":true,"count":3})",
    R"({"type":"view","eye":[0,1,2],"look_at":[0,0,0],"up":[0,1,0],"yfov":40})",
    R"({"type":"camera","to":"reset"})",
    R"({"type":"focus","x":0.5,"y":0.25})",
    R"({"type":"set","name":"max-depth","value":"4"})",
    R"({"type":"size","width":64,"height":48})",
    R"({"type":"display","shown":"albedo","exposure":"auto","gains":[1,0.5]})",
    R"({"type":"environment","source":"1,1,1","intensity":1,"degrees":0})",
    R"({"type":"target","error":0.01})"};

TEST(ServeMessages, AreReadAsTheyAreMeant) {
  for (const char* text : kMessages) EXPECT_TRUE(parse_message(text)) << text;
  const auto steer = parse_message(kMessages[3]);
  ASSERT_TRUE(steer);
  EXPECT_EQ(steer->kind, MessageKind::steer);
  EXPECT_EQ(steer->drags.left, glm::dvec2(0.1, -0.2));
  EXPECT_EQ(steer->flight.direction, glm::dvec3(0, 0, 1));
  EXPECT_TRUE(steer->dragging);
  EXPECT_EQ(steer->count, 3u);
}

TEST(ServeMessages, OthersAreRefused) {
  for (const char* text : {"",
                           "{}",
                           "[]",
                           "7",
                           "null",
                           "{\"type\":",
                           R"({"type":"dance"})",
                           R"({"type":7})",
                           R"({"type":"ack"})",
                           R"({"type":"ack","frame":-1})",
                           R"({"type":"ack","frame":0.5})",
                           R"({"type":"ack","frame":4294967296})",
                           R"({"type":"ack","frame":1e999})",
                           R"({"type":"hello","token":["x"]})",
                           R"({"type":"focus","x":2,"y":0})",
                           R"({"type":"steer","left":[1e9,0]})",
                           R"({"type":"steer","left":[0,0,0]})",
                           R"({"type":"steer","dragging":1})",
                           R"({"type":"view","yfov":0})",
                           R"({"type":"size","width":64})",
                           R"({"type":"size","width":70000,"height":48})",
                           R"({"type":"display","exposure":"bright"})",
                           R"({"type":"environment","source":"1,1,1","intensity":-1,"degrees":0})",
                           "\xff\xfe{}"})
    EXPECT_FALSE(parse_message(text)) << text;
  EXPECT_FALSE(parse_message(R"({"type":"set","name":"x","value":")" + std::string(kLongestMessage, 'x') + "\"}"));
  EXPECT_FALSE(parse_message(std::string(kLongestMessage, '[')));
}

// Every message with bytes changed, left out and doubled: refused or read, but never more than that.
TEST(ServeMessages, DamagedOnesDoNoHarm) {
  std::mt19937 random(1);
  const auto below = [&](std::size_t count) { return static_cast<std::size_t>(random() % count); };
  int read = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string text = kMessages[below(std::size(kMessages))];
    for (std::size_t changes = 1 + below(4); changes > 0 && !text.empty(); --changes) {
      const std::size_t at = below(text.size());
      if (const std::size_t how = below(4); how == 0)
        text[at] = static_cast<char>(random());
      else if (how == 1)
        text.erase(at, 1 + below(8));
      else if (how == 2)
        text.insert(at, text.substr(below(text.size()), 8));
      else
        text[at] = "0123456789eE+-.,:[]{}\"\\"[below(22)];
    }
    if (const auto message = parse_message(text)) {
      ++read;
      ASSERT_TRUE(std::isfinite(message->drags.scroll) && std::isfinite(message->at.x)) << text;
    }
  }
  EXPECT_GT(read, 100);
}

// A server without a picture, and with little patience.
class ServerTest : public ::testing::Test {
protected:
  void open() {
    request_.token = token_;
    request_.page = kServedPage;
    request_.content_policy = served_page_policy();
    server_ = std::make_unique<Server>(request_);
  }
  void SetUp() override {
    ServerLimits& limits = request_.limits;
    limits.handshake = 1.0, limits.wrong_token = 0.3, limits.new_connections = 1000.0;
    open();
  }
  std::unique_ptr<WebClient> client() { return std::make_unique<WebClient>(server_->port()); }
  std::unique_ptr<WebClient> viewer() {
    auto joined = client();
    EXPECT_TRUE(joined->join(token_));
    EXPECT_TRUE(wait_for(ViewerNews::Kind::joined));
    return joined;
  }
  std::optional<ViewerNews> wait_for(ViewerNews::Kind kind, double seconds = 20.0) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (std::chrono::steady_clock::now() < end) {
      for (ViewerNews& news : server_->take(0.05)) waiting_.push_back(std::move(news));
      for (std::size_t i = 0; i < waiting_.size(); ++i)
        if (waiting_[i].kind == kind) {
          ViewerNews found = waiting_[i];
          waiting_.erase(waiting_.begin() + static_cast<std::ptrdiff_t>(i));
          return found;
        }
    }
    return std::nullopt;
  }
  static double seconds(const std::function<void()>& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  static std::string bytes_of_frame(std::size_t size) { return std::string(size, 'x'); }
  // The server still does its work.
  void expect_alive() {
    auto other = viewer();
    other->say(R"({"type":"copy"})");
    EXPECT_TRUE(wait_for(ViewerNews::Kind::message));
  }

  ServerRequest request_;
  const std::string token_ = make_token();
  std::unique_ptr<Server> server_;
  std::vector<ViewerNews> waiting_;
};

TEST_F(ServerTest, ThePageLoadsNothingFromElsewhere) {
  const std::string answer = client()->get("/");
  EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 ")) << answer.substr(0, 200);
  const std::string head = answer.substr(0, answer.find("\r\n\r\n"));
  for (const char* line : {"Content-Security-Policy: default-src 'none'; script-src 'sha256-", "frame-ancestors 'none'",
                           "connect-src 'self'", "X-Content-Type-Options: nosniff", "Referrer-Policy: no-referrer",
                           "Cross-Origin-Resource-Policy: same-origin", "Cache-Control: no-store"})
    EXPECT_NE(head.find(line), std::string::npos) << line << "\n" << head;
  EXPECT_EQ(head.find("Access-Control"), std::string::npos);
  EXPECT_EQ(head.find("unsafe"), std::string::npos);
  EXPECT_EQ(head.find("Set-Cookie"), std::string::npos);
  EXPECT_EQ(answer.find(token_), std::string::npos);
  EXPECT_EQ(answer.find("src=\"http"), std::string::npos);
}

TEST_F(ServerTest, OnlyGetAndHead) {
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "PATCH", "TRACE"}) {
    const std::string answer = client()->request(fmt::format("{} / HTTP/1.1\r\nHost: localhost", method));
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 405 ")) << method << answer;
    EXPECT_NE(answer.find("Allow: GET, HEAD"), std::string::npos) << method;
  }
  const std::string head = client()->request("HEAD / HTTP/1.1\r\nHost: localhost");
  EXPECT_TRUE(head.starts_with("HTTP/1.1 200 ")) << head;
  EXPECT_TRUE(head.ends_with("\r\n\r\n")) << head;
  EXPECT_TRUE(client()->get("/../../etc/passwd").starts_with("HTTP/1.1 404 "));
  EXPECT_TRUE(client()->get("/session").starts_with("HTTP/1.1 426 "));
  EXPECT_TRUE(client()->request("no HTTP at all").starts_with("HTTP/1.1 400 "));
}

TEST_F(ServerTest, ForeignHostsAndOriginsAreRefused) {
  const auto status = [&](const std::string& lines) {
    return client()->request("GET / HTTP/1.1\r\n" + lines).substr(9, 3);
  };
  EXPECT_EQ(status("Host: localhost:99"), "200"); // as through a tunnel
  EXPECT_EQ(status("Host: evil.example"), "403");
  EXPECT_EQ(status("Accept: */*"), "403"); // without any
  EXPECT_EQ(status("Host: localhost\r\nHost: evil.example"), "403");
  EXPECT_EQ(status("Host: localhost\r\nOrigin: http://localhost:8740"), "200");
  EXPECT_EQ(status("Host: localhost\r\nOrigin: http://evil.example"), "403");
  EXPECT_EQ(status("Host: localhost\r\nOrigin: null"), "403");
  // A name that the attacker lets point here makes both the same.
  EXPECT_EQ(client()->open("evil.example", "\r\nOrigin: http://evil.example"), 403);
  EXPECT_EQ(client()->open("localhost", "\r\nOrigin: http://evil.example"), 403);
  EXPECT_EQ(client()->open("localhost", "\r\nOrigin: http://localhost:1"), 101);
  EXPECT_EQ(client()->open("localhost"), 101); // no browser: it needs the token all the same
  server_.reset();
  request_.hosts = {"render.example.org"};
  open();
  EXPECT_EQ(client()->open("render.example.org", "\r\nOrigin: https://render.example.org"), 101);
  EXPECT_EQ(client()->open("evil.example", "\r\nOrigin: https://render.example.org"), 403);
}

TEST_F(ServerTest, ItsPortIsOfThisMachineAlone) {
  const std::string line = fmt::format(":{:04X} ", server_->port());
  std::string listened;
  for (const char* table : {"/proc/net/tcp", "/proc/net/tcp6"}) {
    std::ifstream file(table);
    for (std::string row; std::getline(file, row);)
      if (row.find(line) != std::string::npos && row.find(" 0A ") != std::string::npos)
        listened += row.substr(row.find(':') + 2, row.find(line) - row.find(':') - 2) + " ";
  }
  EXPECT_NE(listened.find("0100007F"), std::string::npos) << listened;
  for (const char* any : {"00000000 ", "00000000000000000000000000000000 "})
    EXPECT_FALSE(listened.starts_with(any) || listened.find(std::string(" ") + any) != std::string::npos) << listened;
  // A second server cannot have it, and says so.
  ServerRequest again = request_;
  again.port = server_->port();
  EXPECT_THROW(Server{again}, Error);
}

TEST_F(ServerTest, WhoHasNoTokenIsLetGo) {
  auto silent = client();
  ASSERT_EQ(silent->open(), 101);
  EXPECT_EQ(silent->close_code(10.0), 0); // after limits.handshake

  auto wrong = client();
  ASSERT_TRUE(wrong->join(make_token()));
  int code = 0;
  const double took = seconds([&] { code = wrong->close_code(); });
  EXPECT_EQ(code, 1008);
  EXPECT_GE(took, 0.2); // limits.wrong_token

  auto early = client();
  ASSERT_EQ(early->open(), 101);
  early->say(R"({"type":"copy"})");
  EXPECT_EQ(early->close_code(), 1008);
  EXPECT_EQ(server_->viewers(), 0u);
  EXPECT_FALSE(wait_for(ViewerNews::Kind::message, 0.2));
  expect_alive();
}

TEST_F(ServerTest, FilesNeedTheToken) {
  EXPECT_TRUE(client()->get("/picture.png").starts_with("HTTP/1.1 401 "));
  EXPECT_TRUE(client()->get("/picture.png?token=" + token_).starts_with("HTTP/1.1 404 "));
  EXPECT_TRUE(client()->get("/picture.exr", "\r\nAuthorization: Bearer " + make_token()).starts_with("HTTP/1.1 401 "));
  EXPECT_FALSE(wait_for(ViewerNews::Kind::wants_file, 0.2));
  std::string answer;
  std::thread reader([&] { answer = client()->get("/picture.exr", "\r\nAuthorization: Bearer " + token_); });
  const auto wanted = wait_for(ViewerNews::Kind::wants_file);
  if (wanted) server_->answer_file(wanted->viewer, "box.exr", "picture");
  reader.join();
  ASSERT_TRUE(wanted);
  EXPECT_EQ(wanted->format, "exr");
  EXPECT_NE(answer.find("filename=\"box.exr\""), std::string::npos) << answer;
  EXPECT_TRUE(answer.ends_with("\r\n\r\npicture")) << answer;
}

TEST_F(ServerTest, LongAndSlowRequestsAreLetGo) {
  const std::string answer = client()->get("/", "\r\nX: " + std::string(9000, 'x'));
  EXPECT_TRUE(answer.empty() || answer.starts_with("HTTP/1.1 431 ")) << answer.substr(0, 100);
  auto slow = client(); // a byte now and then does not help
  bool ended = false;
  const double took = seconds([&] {
    for (int i = 0; i < 40 && !ended; ++i) {
      slow->send_bytes(i == 0 ? "GET / HTTP/1.1\r\nX: " : "x");
      slow->read_to_end(0.1, &ended);
    }
  });
  EXPECT_TRUE(ended);
  EXPECT_LT(took, 3.5); // limits.handshake, on a busy machine
  expect_alive();
}

TEST_F(ServerTest, MessagesThatAreTooLongOrNoneEndTheViewer) {
  const auto code_after = [&](const std::string& text, int opcode = 1) {
    auto bad = viewer();
    bad->say(text, opcode);
    return bad->close_code();
  };
  EXPECT_EQ(code_after(R"({"type":"set","name":"x","value":")" + std::string(5000, 'x') + "\"}"), 1009);
  EXPECT_EQ(code_after(std::string(70000, ' ')), 1009);
  EXPECT_EQ(code_after("{}"), 1008);
  EXPECT_EQ(code_after(R"({"type":"hello","token":"x"})"), 1008); // again
  EXPECT_EQ(code_after("xx", 2), 1003);
  auto huge = viewer(); // announced only
  huge->send_bytes(std::string("\x81\xff\x7f\xff\xff\xff\xff\xff\xff\xff\0\0\0\0", 14));
  EXPECT_GE(huge->close_code(), 0);
  auto unmasked = viewer();
  unmasked->send_bytes(std::string("\x81\x02{}"));
  EXPECT_EQ(unmasked->close_code(), 1002);
  expect_alive();
}

// What comes instead of a request, and instead of messages.
TEST_F(ServerTest, NoiseDoesNoHarm) {
  std::mt19937 random(2);
  const std::string request =
      "GET /session HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Version: 13\r\n\r\n";
  for (int i = 0; i < 200; ++i) {
    auto bad = client();
    std::string bytes = i % 2 ? request : std::string(300, 'x');
    for (std::size_t changes = i % 2 ? 1 + random() % 4 : bytes.size(); changes > 0; --changes)
      bytes[random() % bytes.size()] = static_cast<char>(random());
    bad->send_bytes(bytes);
  }
  for (int i = 0; i < 50; ++i) {
    auto bad = client();
    ASSERT_TRUE(bad->join(token_));
    std::string bytes(200, ' ');
    for (char& byte : bytes) byte = static_cast<char>(random());
    bad->send_bytes(bytes);
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  waiting_.clear();
  server_->take(0.0);
  expect_alive();
}

TEST_F(ServerTest, WhoFloodsIsLetGoAndNobodyElse) {
  auto calm = viewer(), flooding = viewer();
  std::thread sender([&] {
    for (int i = 0; i < 2000; ++i) flooding->say(R"({"type":"copy"})");
  });
  EXPECT_TRUE(wait_for(ViewerNews::Kind::left));
  sender.join();
  EXPECT_EQ(server_->viewers(), 1u);
  // Twice a second's messages, and what was allowed while they came.
  std::size_t taken = waiting_.size();
  for (const auto& news : server_->take(0.2)) taken += news.kind == ViewerNews::Kind::message ? 1 : 0;
  EXPECT_LT(taken, 1000u);
  waiting_.clear();
  calm->say(R"({"type":"copy"})");
  EXPECT_TRUE(wait_for(ViewerNews::Kind::message));

  auto acknowledging = viewer();
  for (int i = 0; i < 2000; ++i) acknowledging->say(R"({"type":"ack","frame":99})"); // of pictures that never were
  EXPECT_TRUE(wait_for(ViewerNews::Kind::left));
}

TEST_F(ServerTest, ConnectionsAreFewAtOnce) {
  server_.reset();
  request_.limits.connections = 4, request_.limits.handshake = 20.0;
  open();
  std::vector<std::unique_ptr<WebClient>> held;
  for (int i = 0; i < 4; ++i) {
    held.push_back(client());
    held.back()->send_bytes("GET / "); // so that it is there before the next
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  bool ended = false;
  EXPECT_EQ(client()->read_to_end(10.0, &ended), "");
  EXPECT_TRUE(ended);
  held.clear();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  expect_alive();
}

TEST_F(ServerTest, ConnectionsComeNoFasterThanAllowed) {
  server_.reset();
  request_.limits.new_connections = 5.0;
  open();
  const double took = seconds([&] {
    for (int i = 0; i < 20; ++i) EXPECT_TRUE(client()->get("/").starts_with("HTTP/1.1 200 ")) << i;
  });
  EXPECT_GE(took, 1.8); // ten at once, ten more at five a second
}

TEST_F(ServerTest, TwoPicturesGoOutUnacknowledgedThenTheNewest) {
  auto watching = viewer(), slow = viewer();
  const auto number_of = [](const std::optional<WebMessage>& message) {
    return message && message->opcode == 2 ? std::stoi(message->bytes) : -1;
  };
  for (int frame = 1; frame <= 6; ++frame) {
    server_->show(static_cast<std::uint32_t>(frame), std::to_string(frame));
    EXPECT_EQ(number_of(watching->next()), frame);
    watching->say(fmt::format(R"({{"type":"ack","frame":{}}})", frame));
  }
  // Of six pictures the slow one got two; once it acknowledges them, the newest.
  EXPECT_EQ(number_of(slow->next()), 1);
  EXPECT_EQ(number_of(slow->next()), 2);
  EXPECT_FALSE(slow->next(0.3));
  server_->show(5, "5"); // overtaken on its way
  slow->say(R"({"type":"ack","frame":2})");
  EXPECT_EQ(number_of(slow->next()), 6);
  EXPECT_FALSE(watching->next(0.1));
  EXPECT_TRUE(server_->wants_frame());
}

TEST_F(ServerTest, NoPictureIsWantedWhereNobodyAcknowledges) {
  EXPECT_FALSE(server_->wants_frame());
  auto slow = viewer();
  EXPECT_TRUE(server_->wants_frame());
  for (std::uint32_t frame = 1; frame <= 2; ++frame) {
    server_->show(frame, "picture");
    EXPECT_TRUE(slow->next());
  }
  EXPECT_FALSE(server_->wants_frame());
}

TEST_F(ServerTest, WhoAcknowledgesNothingOrReadsNothingIsLetGo) {
  server_.reset();
  request_.limits.silence = 2.0; // elsewhere longer than any test, as its viewers answer pings only when they read
  open();
  auto deaf = viewer(); // answers pings, but shows no picture
  server_->show(1, "picture");
  EXPECT_GE(deaf->close_code(10.0), 0);
  EXPECT_TRUE(wait_for(ViewerNews::Kind::left));

  auto stopped = viewer(); // reads nothing at all
  auto calm = viewer();
  for (std::uint32_t frame = 2; frame < 8; ++frame) {
    server_->show(frame, bytes_of_frame(8 << 20));
    const auto got = calm->next(); // is not held up
    ASSERT_TRUE(got && got->opcode == 2);
    calm->say(fmt::format(R"({{"type":"ack","frame":{}}})", frame));
  }
  EXPECT_TRUE(wait_for(ViewerNews::Kind::left, 10.0));
  EXPECT_EQ(server_->viewers(), 1u);
}

TEST_F(ServerTest, AnswersThatNobodyReadsArePiledNoHigherThanAllowed) {
  auto stopped = viewer();
  for (int i = 0; i < 400; ++i)
    server_->send(1, std::string(1 << 16, ' ')), server_->send_to_all(std::string(1 << 16, ' '));
  EXPECT_TRUE(wait_for(ViewerNews::Kind::left));
  expect_alive();
}

TEST_F(ServerTest, ViewersWhoVanishLeave) {
  auto gone = viewer();
  EXPECT_EQ(server_->viewers(), 1u);
  gone->leave();
  EXPECT_TRUE(wait_for(ViewerNews::Kind::left));
  EXPECT_EQ(server_->viewers(), 0u);
  expect_alive();
}

TEST(ServeFrames, BeginWithWhatTheyShow) {
  FrameHeader header;
  header.number = 0x01020304, header.count = 5, header.spp = 6, header.coarse = 7, header.format = FrameFormat::png;
  header.done = 1, header.width = 0x0102, header.height = 9, header.error = 1.0f, header.seconds = 2.0f;
  const std::string bytes = bytes_of(header);
  ASSERT_EQ(bytes.size(), kFrameHeaderBytes);
  EXPECT_EQ(bytes, std::string("\x04\x03\x02\x01\x05\0\0\0\x06\0\0\0\x07\0\x02\0\x01\0\0\0\x02\x01\x09\0"
                               "\0\0\x80\x3f\0\0\0\x40",
                               32));
}

// A process of `wavepath serve`, and what it tells a viewer.
class Served {
public:
  Served(const std::string& folder, std::vector<std::string> flags) : out_(folder + "/out"), err_(folder + "/err") {
    flags.insert(flags.begin(), {WAVEPATH_BINARY, "serve", kCornell, "--port", "0"});
    std::vector<char*> pointers;
    for (std::string& flag : flags) pointers.push_back(flag.data());
    pointers.push_back(nullptr);
    std::filesystem::remove(out_);
    child_ = fork();
    if (child_ == 0) {
      dup2(::open(out_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), STDOUT_FILENO);
      dup2(::open(err_.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0600), STDERR_FILENO);
      execv(pointers[0], pointers.data());
      _exit(99);
    }
    for (int i = 0; i < 1200 && out().find('\n') == std::string::npos; ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    const std::string address = out();
    const std::size_t port = address.find(':', 5), token = address.find("/#");
    if (token == std::string::npos) return;
    port_ = static_cast<std::uint16_t>(std::stoi(address.substr(port + 1)));
    token_ = address.substr(token + 2, 64);
  }
  ~Served() {
    if (child_ > 0) kill(child_, SIGKILL), waitpid(child_, nullptr, 0);
  }
  Served(Served&&) = delete;

  std::uint16_t port() const { return port_; }
  const std::string& token() const { return token_; }
  std::string out() const { return contents(out_); }
  std::string err() const { return contents(err_); }
  int end(int signal) {
    kill(child_, signal);
    int status = 0;
    waitpid(std::exchange(child_, 0), &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

private:
  static std::string contents(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
  }

  std::string out_, err_;
  pid_t child_ = -1;
  std::uint16_t port_ = 0;
  std::string token_;
};

DecodedImage decode_any(const std::vector<std::uint8_t>& file) {
  const std::optional<FileFormat> format = file_format(file);
  if (!format) throw ImageError("is of no known format");
  return decode(*format, file, [](const ImageShape&) {});
}

struct SeenFrame {
  std::uint32_t number = 0, count = 0, spp = 0, coarse = 0, format = 0, done = 0, width = 0, height = 0;
  DecodedImage image;
};

// A viewer of the program, which acknowledges what it gets.
class Watcher {
public:
  explicit Watcher(const Served& served) : client_(served.port()) { EXPECT_TRUE(client_.join(served.token())); }

  void say(Json message) { client_.say(message.dump()); }
  // The next text of this kind; pictures before it are acknowledged.
  Json heard(const std::string& type, double seconds = 60.0) {
    while (auto message = client_.next(seconds)) {
      if (message->opcode == 8) break;
      if (message->opcode == 2) take(*message);
      if (message->opcode != 1) continue;
      Json text = Json::parse(message->bytes);
      if (text["type"] == type) return text;
    }
    ADD_FAILURE() << "nothing of " << type;
    return {};
  }
  // The first picture that is as wanted.
  SeenFrame seen(const std::function<bool(const SeenFrame&)>& wanted, double seconds = 60.0) {
    while (auto message = client_.next(seconds)) {
      if (message->opcode == 8) break;
      if (message->opcode != 2) continue;
      SeenFrame frame = take(*message);
      if (wanted(frame)) return frame;
    }
    ADD_FAILURE() << "no such picture";
    return {};
  }

private:
  SeenFrame take(const WebMessage& message) {
    const auto word = [&](std::size_t at, std::size_t bytes) {
      std::uint32_t value = 0;
      for (std::size_t i = 0; i < bytes; ++i)
        value |= static_cast<std::uint32_t>(static_cast<unsigned char>(message.bytes[at + i])) << 8 * i;
      return value;
    };
    SeenFrame frame{word(0, 4),  word(4, 4),  word(8, 4),  word(12, 2), word(14, 2),
                    word(16, 4), word(20, 2), word(22, 2), {}};
    const auto* first = reinterpret_cast<const std::uint8_t*>(message.bytes.data()) + kFrameHeaderBytes;
    const std::vector<std::uint8_t> file(first, first + message.bytes.size() - kFrameHeaderBytes);
    frame.image = decode_any(file);
    say({{"type", "ack"}, {"frame", frame.number}});
    return frame;
  }

  WebClient client_;
};

bool is_done(const SeenFrame& frame) { return frame.done != 0; }

class ServeProgram : public ProgramTest {
protected:
  std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  Outcome run(const std::string& line) const {
    return run_program({"/bin/sh", "-c", line}, {.folder = folder_.path().string()});
  }
  static DecodedImage decoded(const std::string& file) {
    std::ifstream stream(file, std::ios::binary);
    const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
    return decode_any(std::vector<std::uint8_t>(bytes.begin(), bytes.end()));
  }
  static int largest_difference(const DecodedImage& a, const DecodedImage& b) {
    if (a.shape.width != b.shape.width || a.shape.height != b.shape.height || a.bytes.size() != b.bytes.size())
      return 999;
    int largest = 0;
    for (std::size_t i = 0; i < a.bytes.size(); ++i) largest = std::max(largest, std::abs(a.bytes[i] - b.bytes[i]));
    return largest;
  }
  void rendered_alike(Watcher& watcher, const DecodedImage& shown) {
    watcher.say({{"type", "copy"}});
    const std::string line = watcher.heard("copied")["line"];
    const Outcome outcome = run("wavepath() { " WAVEPATH_BINARY " \"$@\" -q; }; " + line + " -o again.png");
    ASSERT_EQ(outcome.exit_code, 0) << line << outcome.err;
    EXPECT_LE(largest_difference(shown, decoded(path("again.png"))), 1) << line;
  }

  TemporaryFolder folder_;
};

TEST_F(ServeProgram, ThePictureAtRestIsThatOfRender) {
  const Served served(folder_.path().string(),
                      {"--size", "64x48", "--spp", "8", "--max-depth", "3", "--exposure", "auto"});
  ASSERT_NE(served.port(), 0) << served.err();
  Watcher watcher(served);
  const Json scene = watcher.heard("scene");
  EXPECT_EQ(scene["scene"], "cornell_box.gltf");
  EXPECT_GT(scene["settings"].size(), 5u);
  SeenFrame frame = watcher.seen(is_done);
  EXPECT_EQ(frame.format, 2u);
  EXPECT_EQ(frame.spp, 8u);
  EXPECT_EQ(frame.coarse, 1u);
  EXPECT_EQ(frame.width, 64u);
  rendered_alike(watcher, frame.image);

  // After a move it is another one, told by the count of the message.
  watcher.say({{"type", "steer"}, {"left", {0.1, 0.05}}, {"count", 7}});
  frame = watcher.seen([](const SeenFrame& seen) { return seen.done && seen.count == 7; });
  EXPECT_GT(largest_difference(frame.image, decoded(path("again.png"))), 8);
  rendered_alike(watcher, frame.image);

  // So are the files, to the bit.
  const auto file = [&](const std::string& name) {
    const std::string answer = WebClient(served.port()).get("/" + name, "\r\nAuthorization: Bearer " + served.token());
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 200 ")) << answer.substr(0, 200);
    return answer.substr(answer.find("\r\n\r\n") + 4);
  };
  std::ofstream(path("saved.png"), std::ios::binary) << file("picture.png");
  std::ofstream(path("saved.exr"), std::ios::binary) << file("picture.exr");
  EXPECT_EQ(largest_difference(decoded(path("saved.png")), decoded(path("again.png"))), 0);
  watcher.say({{"type", "copy"}});
  const std::string line = watcher.heard("copied")["line"];
  const Outcome outcome = run("wavepath() { " WAVEPATH_BINARY " \"$@\"; }; " + line +
                              " -q -o again.exr && wavepath compare saved.exr again.exr --max mse=0");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.out << outcome.err;
}

TEST_F(ServeProgram, ViewersSetWhatTheTableHasAndNothingElse) {
  const Served served(folder_.path().string(), {"--size", "32x24", "--spp", "4", "--max-depth", "2"});
  ASSERT_NE(served.port(), 0) << served.err();
  Watcher watcher(served);
  EXPECT_EQ(watcher.heard("role")["steers"], true);
  const auto value_of = [](const Json& scene, const std::string& name) {
    for (const Json& row : scene["settings"])
      if (row["name"] == name) return row["value"].get<std::string>();
    return std::string("none");
  };
  const auto planned = [](const Json& scene, const std::string& what) {
    for (const Json& step : scene["plan"])
      if (step["what"] == what) return step["taken"].get<std::string>();
    return std::string("none");
  };
  watcher.say({{"type", "set"}, {"name", "max-depth"}, {"value", "1"}});
  EXPECT_EQ(value_of(watcher.heard("scene"), "max-depth"), "1");
  watcher.say({{"type", "set"}, {"name", "sampler"}, {"value", "independent"}});
  EXPECT_EQ(value_of(watcher.heard("scene"), "sampler"), "independent");
  watcher.say({{"type", "set"}, {"name", "light-samples"}, {"value", "4"}});
  const Json lit = watcher.heard("scene");
  EXPECT_EQ(value_of(lit, "light-samples"), "4");
  EXPECT_EQ(planned(lit, "light-samples"), "4") << lit["plan"];
  EXPECT_NE(planned(lit, "bvh"), "none") << lit["plan"];
  watcher.say({{"type", "size"}, {"width", 40}, {"height", 30}});
  EXPECT_EQ(watcher.heard("scene")["width"], 40);
  watcher.say({{"type", "display"}, {"shown", "albedo"}, {"tonemap", "aces"}, {"exposure", 1.5}});
  Json scene = watcher.heard("scene");
  while (scene["show"] != "albedo" || scene["width"] != 40) scene = watcher.heard("scene");
  EXPECT_EQ(scene["tonemap"], "aces");
  EXPECT_EQ(scene["exposure"], 1.5);
  const SeenFrame albedo = watcher.seen([](const SeenFrame& seen) { return seen.done && seen.width == 40; });
  EXPECT_EQ(albedo.image.shape.height, 30u);

  const std::vector<std::pair<Json, const char*>> refused = {
      {{{"type", "set"}, {"name", "max-depth"}, {"value", "many"}}, "max-depth"},
      {{{"type", "set"}, {"name", "output"}, {"value", "/tmp/x"}}, "no setting"},
      {{{"type", "set"}, {"name", "aov"}, {"value", "albedo"}}, "no setting"},
      {{{"type", "set"}, {"name", "size"}, {"value", "9x9"}}, "no setting"},
      {{{"type", "size"}, {"width", 65535}, {"height", 65535}}, "no size"},
      {{{"type", "size"}, {"width", 0}, {"height", 8}}, "no size"},
      {{{"type", "camera"}, {"to", "99"}}, "none of the scene"},
      {{{"type", "camera"}, {"to", "../x"}}, "none of the scene"},
      {{{"type", "display"}, {"shown", "secrets"}}, "nothing that"},
      {{{"type", "display"}, {"tonemap", "secrets"}}, "no tone curve"},
      {{{"type", "view"}, {"eye", {0, 0, 0}}, {"look_at", {0, 0, 0}}}, ""},
      {{{"type", "environment"}, {"source", "/etc/passwd"}, {"intensity", 1}, {"degrees", 0}}, "server's disk"},
      {{{"type", "environment"}, {"source", "sky.exr"}, {"intensity", 1}, {"degrees", 0}}, "server's disk"}};
  for (const auto& [message, why] : refused) {
    watcher.say(message);
    const std::string text = watcher.heard("note")["text"];
    EXPECT_NE(text.find(why), std::string::npos) << message << text;
  }
  watcher.say({{"type", "environment"}, {"source", "0.5,0.25,1"}, {"intensity", 2}, {"degrees", 0}});
  scene = watcher.heard("scene");
  while (scene["environment"]["source"] != "0.5,0.25,1") scene = watcher.heard("scene");
  EXPECT_EQ(value_of(scene, "max-depth"), "1"); // what was refused changed nothing
  EXPECT_EQ(scene["width"], 40);
}

TEST_F(ServeProgram, APickTellsWhatIsThere) {
  const Served served(folder_.path().string(), {"--size", "32x24", "--spp", "2", "--max-depth", "1"});
  ASSERT_NE(served.port(), 0) << served.err();
  Watcher watcher(served);
  watcher.seen(is_done);
  watcher.say({{"type", "pick"}, {"x", 0.5}, {"y", 0.97}});
  const Json floor = watcher.heard("picked");
  EXPECT_EQ(floor["node"], "floor") << floor;
  EXPECT_EQ(floor["material"], "white") << floor;
  EXPECT_NEAR(floor["point"][1].get<double>(), 0.0, 1e-3) << floor;
  EXPECT_EQ(floor["values"][0]["name"], "R");
  EXPECT_EQ(floor["spp"], 2);
  watcher.say({{"type", "pick"}, {"x", 0.02}, {"y", 0.5}});
  EXPECT_TRUE(watcher.heard("picked")["node"].is_null()); // beside the box
}

TEST_F(ServeProgram, OneSteersAndOthersWatch) {
  const Served served(folder_.path().string(), {"--size", "32x24", "--spp", "2", "--max-depth", "1"});
  ASSERT_NE(served.port(), 0) << served.err();
  auto first = std::make_unique<Watcher>(served);
  EXPECT_EQ(first->heard("role")["steers"], true);
  Watcher second(served);
  EXPECT_EQ(second.heard("role")["steers"], false);
  second.seen(is_done);
  second.say({{"type", "steer"}, {"left", {0.1, 0.1}}, {"count", 9}});
  EXPECT_NE(second.heard("note")["text"].get<std::string>().find("steers"), std::string::npos);
  first->say({{"type", "steer"}, {"left", {0.0, 0.1}}, {"count", 1}});
  second.seen([](const SeenFrame& frame) { return frame.count == 1; }); // both see it
  second.say({{"type", "take"}});
  const Json asked = first->heard("role");
  EXPECT_EQ(asked["steers"], true);
  EXPECT_EQ(asked["asked"], true);
  first->say({{"type", "give"}});
  EXPECT_EQ(first->heard("role")["steers"], false);
  EXPECT_EQ(second.heard("role")["steers"], true);
  second.say({{"type", "steer"}, {"left", {0.1, 0.1}}, {"count", 10}});
  second.seen([](const SeenFrame& frame) { return frame.count == 10; });
  first->say({{"type", "take"}});
  EXPECT_EQ(second.heard("role")["asked"], true);
  first.reset(); // who has gone gets nothing
  second.say({{"type", "steer"}, {"left", {0.1, 0.1}}, {"count", 11}});
  second.seen([](const SeenFrame& frame) { return frame.count == 11; });
  Watcher third(served);
  EXPECT_EQ(third.heard("role")["steers"], false);
}

TEST_F(ServeProgram, EndsWhenToldAndRefusesWhatItCannotServe) {
  Served served(folder_.path().string(), {"--size", "32x24", "--spp", "2"});
  ASSERT_NE(served.port(), 0) << served.err();
  EXPECT_EQ(served.err().find("--listen"), std::string::npos) << served.err();
  const std::string serve = std::string(WAVEPATH_BINARY) + " serve " + kCornell;
  const Outcome taken = run(fmt::format("{} --port {}", serve, served.port()));
  EXPECT_EQ(taken.exit_code, 1);
  EXPECT_NE(taken.err.find("another --port"), std::string::npos) << taken.err;
  EXPECT_EQ(served.end(SIGINT), 0);
  EXPECT_EQ(run(serve + " --listen nowhere").exit_code, 2);
  EXPECT_EQ(run(serve + " --show shadow-error --integrator hybrid").exit_code, 2);
  EXPECT_EQ(run(serve + " --port 70000").exit_code, 2);
  Served open(folder_.path().string(), {"--size", "32x24", "--spp", "2", "--listen", "0.0.0.0"});
  ASSERT_NE(open.port(), 0) << open.err();
  EXPECT_NE(open.err().find("without encryption"), std::string::npos) << open.err();
  EXPECT_NE(open.err().find("ssh -L"), std::string::npos) << open.err();
  EXPECT_EQ(open.end(SIGTERM), 0);
}

} // namespace
} // namespace wavepath::test
