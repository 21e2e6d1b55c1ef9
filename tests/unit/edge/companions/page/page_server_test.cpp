// Page server over HTTP, on a site with a synthetic log and the answers of the real bess-edge.
#include <gmock/gmock.h>
#include <httplib.h>
#include <signal.h>

#include <atomic>
#include <filesystem>
#include <random>
#include <set>
#include <sstream>
#include <thread>

#include "edge/companions/page/page_server.h"
#include "shared/features.h"
#include "shared/file_descriptor.h"
#include "shared/host/json.h"
#include "shared/host/run_program.h"
#include "tests/support/loopback_socket.h"
#include "tests/unit/edge/companions/page/page_site.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class PageServerTest : public ::testing::Test {
 protected:
  PageServerTest() { signal(SIGPIPE, SIG_IGN); }
  ~PageServerTest() override { stop(); }

  void serve() { serve(site_.settings()); }
  void serve(const PageSettings& settings) {
    settings_ = settings;
    server_ = std::make_unique<PageServer>(settings_);
    std::string error;
    ASSERT_TRUE(server_->bind(error)) << error;
    thread_ = std::thread([this] { server_->serve(); });
    ASSERT_EQ(get("/page.css").status, 200);  // it listens
  }
  void stop() {
    if (thread_.joinable()) {
      server_->stop();
      thread_.join();
    }
  }

  struct Got {
    int status = 0;
    std::string body;
    httplib::Headers headers;
  };
  static Got got(const httplib::Result& result) {
    return result ? Got{result->status, result->body, result->headers} : Got{};
  }
  [[nodiscard]] httplib::Client client() const {
    httplib::Client client("127.0.0.1", server_->port());
    client.set_read_timeout(60);
    return client;
  }
  [[nodiscard]] Got get(const std::string& path, const httplib::Headers& headers = {}) const {
    return got(client().Get(path.c_str(), headers));
  }
  /// Direct output of bess-edge.
  [[nodiscard]] std::string printed(std::vector<std::string> words) const {
    words.insert(words.begin(), BESS_EDGE_PROGRAM);
    words.insert(words.end(), {"--config", site_.config()});
    return run_and_capture(words, 30).output;
  }
  /// Settings whose controller is this shell script.
  [[nodiscard]] PageSettings with_program(const std::string& script) const {
    PageSettings settings = site_.settings();
    settings.program = site_.folder.write_script("program", script);
    return settings;
  }
  static std::string header(const Got& got, const char* name) {
    const auto found = got.headers.find(name);
    return found == got.headers.end() ? "" : found->second;
  }
  static std::string trouble(const Got& got) {
    EXPECT_EQ(got.status, 503);
    EXPECT_EQ(header(got, "Content-Type"), "application/json");
    return Json::parse(got.body).value()["trouble"].text_or("");
  }

  PageSite site_;
  PageSettings settings_;
  std::unique_ptr<PageServer> server_;
  std::thread thread_;
};

/// A connection that sends raw bytes, and receives until the end or 10 s.
std::string answer_to(int port, const std::string& request) {
  sockaddr_in address = loopback_address(static_cast<std::uint16_t>(port));
  const FileDescriptor fd(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const timeval patience{.tv_sec = 10, .tv_usec = 0};
  setsockopt(fd.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  EXPECT_EQ(connect(fd.get(), reinterpret_cast<sockaddr*>(&address), sizeof address), 0);
  send(fd.get(), request.data(), request.size(), MSG_NOSIGNAL);
  shutdown(fd.get(), SHUT_WR);
  std::string answer;
  char part[4'096];
  for (ssize_t size = 0; (size = recv(fd.get(), part, sizeof part, 0)) > 0;) {
    answer.append(part, static_cast<std::size_t>(size));
  }
  return answer;
}

TEST_F(PageServerTest, FilesAreThereAndNothingElseIs) {
  serve();
  const std::pair<const char*, const char*> files[] = {
      {"/", "text/html; charset=utf-8"},
      {"/document.css", "text/css; charset=utf-8"},
      {"/page.css", "text/css; charset=utf-8"},
      {"/page.js", "text/javascript; charset=utf-8"},
      {"/charts.js", "text/javascript; charset=utf-8"},
      {"/chart.min.js", "text/javascript; charset=utf-8"}};
  for (const auto& [path, type] : files) {
    const Got file = get(path);
    EXPECT_EQ(file.status, 200) << path;
    EXPECT_EQ(header(file, "Content-Type"), type) << path;
    EXPECT_THAT(header(file, "Content-Security-Policy"), HasSubstr("default-src 'none'")) << path;
    const Got head = got(client().Head(path));
    EXPECT_EQ(head.status, 200) << path;
    EXPECT_EQ(head.body, "") << path;
  }
  EXPECT_THAT(get("/").body, HasSubstr("<noscript>"));
  for (const char* const path : {"/page.html", "/orders", "/statement", "/api", "/api/nothing"}) {
    EXPECT_EQ(get(path).status, 404) << path;
  }
}

TEST_F(PageServerTest, AnswersAreWhatBessEdgePrints) {
  serve();
  EXPECT_EQ(get("/api/why").body, printed({"why", "--json"}));
  EXPECT_EQ(get("/api/month").body, printed({"earned", "month", "--json"}));
  const Got log = get("/api/log");
  EXPECT_EQ(log.body, printed({"log", "--csv", "--last", "720"}));
  EXPECT_EQ(std::count(log.body.begin(), log.body.end(), '\n'), 401);  // and the header
  EXPECT_EQ(get("/api/day?date=2023-03-26").body, log.body);
  for (const char* const date : {"", "?date=", "?date=2023-3-26", "?date=--since=0000"}) {
    EXPECT_EQ(get(std::string("/api/day") + date).status, 400) << date;
  }
  // No controller runs here: its exit code says so, and there is an answer all the same.
  const Got status = get("/api/status");
  EXPECT_EQ(status.status, 200);
  EXPECT_STREQ(Json::parse(status.body).value()["health"].text_or(""), "not running");
  EXPECT_STREQ(Json::parse(status.body).value()["contact"].text_or(""), "Ann & Bo, +32 2");
}

TEST_F(PageServerTest, OnlyGetAndHeadAreAllowed) {
  serve();
  const Got posted = got(client().Post("/orders", "order=clear", "text/plain"));
  EXPECT_EQ(posted.status, 405);
  EXPECT_EQ(header(posted, "Allow"), "GET, HEAD");
  EXPECT_EQ(got(client().Put("/", "x", "text/plain")).status, 405);
  EXPECT_EQ(got(client().Delete("/api/status")).status, 405);
  EXPECT_EQ(got(client().Options("/")).status, 405);
}

TEST_F(PageServerTest, AnotherHostNameIsRefused) {
  serve();
  for (const char* const path : {"/", "/api/status", "/metrics", "/page.css", "/nothing"}) {
    EXPECT_EQ(get(path, {{"Host", "evil.example"}}).status, 421) << path;
  }
}

TEST_F(PageServerTest, AnAbsentControllerIsReported) {
  PageSettings settings = site_.settings();
  settings.program = site_.folder.file("not there");
  serve(settings);
  EXPECT_EQ(get("/").status, 200);
  for (const char* const path :
       {"/api/status", "/api/why", "/api/month", "/api/log", "/api/map", "/metrics"}) {
    EXPECT_THAT(trouble(get(path)), HasSubstr(settings.program)) << path;
  }
}

TEST_F(PageServerTest, WhatIsNoJsonIsNoAnswer) {
  serve(with_program("echo '{\"health\":'; echo 'the card is gone' >&2\n"));
  EXPECT_EQ(trouble(get("/api/status")), "the card is gone");
}

/// While a command runs the previous answer remains, with its age; then there is none.
TEST_F(PageServerTest, AHangingControllerIsReported) {
  const std::string hangs = site_.folder.file("hangs");
  const std::string started = site_.folder.file("started");
  PageSettings settings =
      with_program("[ ! -e '" + hangs + "' ] || { : >'" + started + "'; sleep 60; }\necho '{}'\n");
  settings.refresh_s = 1;
  serve(settings);
  EXPECT_EQ(header(get("/api/status"), "Age"), "0");
  ASSERT_EQ(site_.folder.write("hangs", ""), hangs);
  std::this_thread::sleep_for(std::chrono::milliseconds(1'100));
  Got waited;
  std::thread waits([&] { waited = get("/api/status"); });
  for (int i = 0; i < 6'000 && !std::filesystem::exists(started); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const Got old = get("/api/status");
  EXPECT_EQ(old.status, 200);
  EXPECT_GE(std::stoi("0" + header(old, "Age")), 1);
  waits.join();
  EXPECT_NE(trouble(waited), "");
}

TEST_F(PageServerTest, ManyParallelReadersAskTheControllerOnce) {
  PageSettings settings = with_program("echo \"$1\" >> " + site_.folder.file("asked") +
                                       "\nexec " BESS_EDGE_PROGRAM " \"$@\"\n");
  settings.refresh_s = 600;
  serve(settings);
  std::vector<std::thread> clients;
  std::atomic<int> good = 0;
  for (int i = 0; i < 50; ++i) {
    clients.emplace_back([&] {
      for (int j = 0; j < 4; ++j)
        good += get(j % 2 == 0 ? "/api/status" : "/api/map").status == 200;
    });
  }
  for (std::thread& thread : clients) thread.join();
  EXPECT_EQ(good, 200);
  std::istringstream asked(text_of_file(site_.folder.file("asked")));
  std::multiset<std::string> words;
  for (std::string word; asked >> word;) words.insert(word);
  EXPECT_EQ(words, (std::multiset<std::string>{"status", "why"}));
}

/// Sixty connections of one address, silent, with half a header, or with a byte now and then: the
/// page is served nevertheless.
TEST_F(PageServerTest, HalfOpenConnectionsBlockNoClient) {
  serve();
  std::vector<std::unique_ptr<FileDescriptor>> rude;
  const sockaddr_in address = loopback_address(static_cast<std::uint16_t>(server_->port()));
  const auto come = [&](int count) {
    for (int i = 0; i < count; ++i) {
      rude.push_back(std::make_unique<FileDescriptor>(socket(AF_INET, SOCK_STREAM, 0)));
      ASSERT_EQ(
          connect(rude.back()->get(), reinterpret_cast<const sockaddr*>(&address), sizeof address),
          0);
      const std::string said = i % 3 == 0 ? "" : "GET / HTTP/1.1\r\nHost: 127.0.0.1\r\nX: ";
      send(rude.back()->get(), said.data(), said.size(), MSG_NOSIGNAL);
    }
  };
  come(60);
  for (int round = 0; round < 6; ++round) {
    EXPECT_EQ(get("/page.css").status, 200) << "with " << rude.size();
    come(10);
    for (const auto& one : rude) send(one->get(), "y", 1, MSG_NOSIGNAL);
  }
}

/// Drawn requests that no browser sends: no crash, and only the page is readable.
TEST_F(PageServerTest, HostileRequestsGetNothing) {
  serve();
  std::mt19937_64 random(20'261'123);
  const std::vector<std::string> methods = {"GET",     "POST", "DELETE", "TRACE",
                                            "CONNECT", "\x01", ""};
  const std::vector<std::string> paths = {"/",
                                          "/../../../../etc/passwd",
                                          "/%2e%2e/%2e%2e/etc/passwd",
                                          "//etc/passwd",
                                          "/api/../../edge.toml",
                                          "/page.css%00.html",
                                          "/\xff\xfe",
                                          "http://evil.example/",
                                          "/?" + std::string(9'000, 'b'),
                                          "/api/%",
                                          "/api/status?x=%zz"};
  const std::vector<std::string> headers = {"Host: evil.example",
                                            "Content-Length: 99999999999999999999",
                                            "Content-Length: -1",
                                            "Content-Length: 1000000",
                                            "Transfer-Encoding: chunked",
                                            "Range: bytes=0-18446744073709551615",
                                            "Range: bytes=9-1,5-",
                                            "Expect: 100-continue",
                                            "X: " + std::string(20'000, 'x'),
                                            "Connection: keep-alive",
                                            ": nothing",
                                            "no colon"};
  const std::vector<std::string> bodies = {"", "ffffffffffffffff\r\n", "\r\n\r\n",
                                           std::string(8'000, '&')};
  const auto pick = [&](const std::vector<std::string>& from) {
    return from[random() % from.size()];
  };
  for (int i = 0; i < 200; ++i) {
    std::string request =
        pick(methods) + " " + pick(paths) + (random() % 8 == 0 ? " HTTP/9" : " HTTP/1.1") + "\r\n";
    for (std::uint64_t k = random() % 4; k > 0; --k) request += pick(headers) + "\r\n";
    if (random() % 2 == 0) request += "Host: 127.0.0.1\r\n";
    request += "Content-Type: application/x-www-form-urlencoded\r\nConnection: close\r\n\r\n" +
               pick(bodies);
    const std::string answer = answer_to(server_->port(), request);
    EXPECT_THAT(answer, Not(HasSubstr("root:"))) << request.substr(0, 200);
    EXPECT_THAT(answer, Not(HasSubstr("[page]\nport"))) << request.substr(0, 200);
  }
  EXPECT_EQ(get("/").status, 200);
}

}  // namespace
}  // namespace bess
