// The page over HTTP, on a site whose log is drawn and whose answers are those of the real
// bess-edge.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <httplib.h>
#include <signal.h>

#include <atomic>
#include <cmath>
#include <map>
#include <pugixml.hpp>
#include <random>
#include <set>
#include <thread>

#include "edge/page/page_html.h"
#include "edge/page/page_server.h"
#include "shared/file_descriptor.h"
#include "tests/edge/page/page_site.h"
#include "tests/support/loopback_socket.h"

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
  [[nodiscard]] Got order(httplib::Params form, const httplib::Headers& headers = {}) const {
    return got(client().Post("/orders", headers, form));
  }
  static httplib::Params hold(const std::string& token = "0123456789abcdef") {
    return {{"order", "hold"}, {"power_w", "-500"}, {"minutes", "30"}, {"token", token}};
  }

  PageSite site_;
  PageSettings settings_;
  std::unique_ptr<PageServer> server_;
  std::thread thread_;
};

/// "month/days/3/earned_eur" in the answers.
JsonValue at_path(const std::map<std::string, Json>& answers, std::string_view path) {
  const auto word = [&path] {
    const std::size_t end = std::min(path.find('/'), path.size());
    const std::string taken(path.substr(0, end));
    path.remove_prefix(std::min(end + 1, path.size()));
    return taken;
  };
  JsonValue value = answers.at(word()).value();
  while (!path.empty()) {
    const std::string key = word();
    if (!value.is_list()) {
      value = value[key.c_str()];
      continue;
    }
    std::size_t index = std::stoul(key);
    JsonValue found;
    for (const JsonValue item : value) {
      if (index-- == 0) found = item;
    }
    value = found;
  }
  return value;
}

/// A connection that sends what it is given, byte by byte as it stands, and takes what comes until
/// the end or 10 s.
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

std::string text_of(const pugi::xml_node& node) {
  std::string text = node.text().get();
  const std::string minus = "\u2212";
  if (text.starts_with(minus)) text.replace(0, minus.size(), "-");
  return text;
}

TEST_F(PageServerTest, EveryNumberIsThatOfTheAnswers) {
  serve();
  pugi::xml_document page;
  const Got html = get("/");
  ASSERT_EQ(html.status, 200);
  const auto parsed =
      page.load_string(html.body.c_str(), pugi::parse_default | pugi::parse_doctype);
  ASSERT_TRUE(parsed) << parsed.description() << " at "
                      << html.body.substr(static_cast<std::size_t>(parsed.offset), 80);
  std::map<std::string, Json> answers;
  for (const char* const name : {"status", "why", "month"}) {
    answers.emplace(name, Json::parse(get(std::string("/api/") + name).body));
  }
  std::set<std::string> shown;
  for (const pugi::xpath_node& found : page.select_nodes("//data")) {
    const pugi::xml_node node = found.node();
    const std::string path = node.attribute("data-of").value();
    const std::optional<double> number = at_path(answers, path).number();
    ASSERT_TRUE(number) << path;
    EXPECT_NEAR(node.attribute("value").as_double(), *number, 1e-9 * std::abs(*number)) << path;
    const std::string text = text_of(node);
    const std::size_t point = text.find('.');
    const auto decimals = point == text.npos ? 0 : static_cast<int>(text.size() - point - 1);
    const double half_digit = 0.5001 * std::pow(10, -decimals);
    EXPECT_NEAR(std::stod(text), *number / node.attribute("data-divisor").as_double(), half_digit)
        << path;
    EXPECT_TRUE(shown.insert(path).second || path.find("earned_eur") != path.npos)
        << path << " stands twice";
  }
  for (const char* const path :
       {"status/last/soc_e4", "status/last/price_centi_eur_per_mwh",
        "why/margins/charge_up_to_eur_per_mwh", "why/margins/discharge_from_eur_per_mwh",
        "month/earned_eur", "month/days/0/charged_kwh"}) {
    EXPECT_EQ(shown.count(path), 1U) << path;
  }
  EXPECT_THAT(html.body, HasSubstr("garage-1"));
  EXPECT_EQ(page.select_nodes("//*[local-name()='svg']").size(), 2U);
}

TEST_F(PageServerTest, DayAndMapAreTheLogsAndTheStudents) {
  serve();
  const Json day = Json::parse(get("/api/today").body);
  ASSERT_EQ(day.value().size(), 400U);
  const Json why = Json::parse(get("/api/why").body);
  const Json map = Json::parse(get("/api/map").body);
  ASSERT_EQ(map.value()["columns"].size(), static_cast<std::size_t>(kSocCount));
  const double soc = why.value()["soc_percent"].number().value();
  for (const JsonValue column : map.value()["columns"]) {
    if (std::abs(column["soc_percent"].number().value() - soc) > 0.249) continue;
    EXPECT_EQ(column["charge_up_to_eur_per_mwh"].number(),
              why.value()["margins"]["charge_up_to_eur_per_mwh"].number());
    EXPECT_EQ(column["discharge_from_eur_per_mwh"].number(),
              why.value()["margins"]["discharge_from_eur_per_mwh"].number());
  }
  EXPECT_EQ(get("/statement").status, 200);
  EXPECT_THAT(get("/").headers.find("Content-Security-Policy")->second,
              HasSubstr("default-src 'none'"));
}

TEST_F(PageServerTest, AnOrderNeedsATokenAndOurOwnPage) {
  serve();
  EXPECT_EQ(order(hold("")).status, 401);
  EXPECT_EQ(order(hold("0123456789abcdeg")).status, 401);
  EXPECT_EQ(order(hold(), {{"Origin", "https://evil.example"}}).status, 403);
  EXPECT_EQ(order(hold(), {{"Origin", "null"}}).status, 403);
  EXPECT_FALSE(std::filesystem::exists(site_.folder.file("state/hold")));
  EXPECT_EQ(order({{"order", "hold"}, {"power_w", "1"}, {"token", "0123456789abcdef"}}).status,
            422);
  const Got done = order(hold());
  EXPECT_EQ(done.status, 200) << done.body;
  EXPECT_THAT(done.body, HasSubstr("hold -500 W"));
  EXPECT_TRUE(std::filesystem::exists(site_.folder.file("state/hold")));
  const Got page = order({{"order", "release"}},
                         {{"Accept", "text/html"},
                          {"Authorization", "Bearer 0123456789abcdef"},
                          {"Origin", "http://127.0.0.1:" + std::to_string(server_->port())}});
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.body, HasSubstr("role=\"alert\""));
  // The limits' file is not configured: bess-edge's own refusal.
  const Got refused = order({{"order", "unlimit"}, {"token", "0123456789abcdef"}});
  EXPECT_EQ(refused.status, 422);
  EXPECT_THAT(refused.body, HasSubstr("[limits]"));
}

TEST_F(PageServerTest, GuessingIsSlow) {
  serve();
  for (int i = 0; i < WrongTokens::kMax; ++i) EXPECT_EQ(order(hold("wrong")).status, 401);
  EXPECT_EQ(order(hold("wrong")).status, 429);
  EXPECT_EQ(order(hold()).status, 429);
  EXPECT_EQ(get("/").status, 200);
}

TEST_F(PageServerTest, WithoutTokensNothingIsOrdered) {
  PageSettings settings = site_.settings();
  settings.tokens = {};
  serve(settings);
  EXPECT_EQ(order(hold()).status, 403);
  EXPECT_EQ(order(hold("")).status, 403);
  EXPECT_THAT(get("/").body, Not(HasSubstr("<form")));
  EXPECT_THAT(get("/").body, HasSubstr("<p>Call: Ann &amp; Bo, +32 2</p>"));
}

TEST_F(PageServerTest, AForeignNameIsNotAnswered) {
  serve();
  for (const char* const path : {"/", "/api/status", "/metrics", "/page.css", "/nothing"}) {
    EXPECT_EQ(get(path, {{"Host", "evil.example"}}).status, 421) << path;
  }
}

/// A controller that cannot be asked is told, and takes nothing else with it.
TEST_F(PageServerTest, WithoutAnAnswerThereIsAPage) {
  PageSettings settings = site_.settings();
  settings.program = site_.folder.file("not there");
  settings.ring = site_.folder.file("no ring");
  serve(settings);
  const Got page = get("/");
  EXPECT_EQ(page.status, 200);
  EXPECT_THAT(page.body, HasSubstr("cannot be started: No such file"));
  EXPECT_TRUE(pugi::xml_document().load_string(page.body.c_str(),
                                               pugi::parse_default | pugi::parse_doctype));
  EXPECT_EQ(Json::parse(get("/api/today").body).value().size(), 0U);
}

TEST_F(PageServerTest, ManyWhoLookAtOnceAskTheControllerOnce) {
  PageSettings settings = site_.settings();
  settings.refresh_s = 600;
  settings.program =
      site_.folder.write("counts", "#!/bin/sh\necho \"$1\" >> " + site_.folder.file("asked") +
                                       "\nexec " BESS_EDGE_PROGRAM " \"$@\"\n");
  ASSERT_EQ(chmod(settings.program.c_str(), 0755), 0);
  serve(settings);
  std::vector<std::thread> clients;
  std::atomic<int> good = 0;
  for (int i = 0; i < 50; ++i) {
    clients.emplace_back([&] {
      for (int j = 0; j < 4; ++j) good += get(j % 2 == 0 ? "/" : "/api/why").status == 200;
    });
  }
  for (std::thread& thread : clients) thread.join();
  EXPECT_EQ(good, 200);
  std::istringstream asked(text_of_file(site_.folder.file("asked")));
  std::string word;
  int count = 0;
  while (asked >> word) count += word == "status";
  EXPECT_EQ(count, 2);  // status, and its metrics
}

/// Sixty connections of one address, which say nothing, a half of a header, or a byte now and then:
/// the page is there all the same, while they stand and while new ones come.
TEST_F(PageServerTest, HalfOpenConnectionsKeepNobodyWaiting) {
  using std::chrono::steady_clock;
  serve();
  static_cast<void>(get("/"));  // its answers are made
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
    const auto asked = steady_clock::now();
    EXPECT_EQ(get("/page.css").status, 200);
    const std::chrono::duration<double> waited = steady_clock::now() - asked;
    std::printf("with %zu of them the page came after %.2f s\n", rude.size(), waited.count());
    EXPECT_LT(waited.count(), 4);
    come(10);
    for (const auto& one : rude) send(one->get(), "y", 1, MSG_NOSIGNAL);
  }
  // Within its patience one that is alone, or nearly, may be as slow as before.
  rude.clear();
  std::this_thread::sleep_for(std::chrono::milliseconds(700));
  come(1);
  std::this_thread::sleep_for(std::chrono::seconds(2));
  const std::string rest = "X: y\r\nConnection: close\r\n\r\n";
  const std::string whole = "GET /page.css HTTP/1.1\r\nHost: 127.0.0.1\r\n" + rest;
  EXPECT_EQ(send(rude.back()->get(), whole.data(), whole.size(), MSG_NOSIGNAL),
            static_cast<ssize_t>(whole.size()));
  char answer[16] = "";
  EXPECT_GT(recv(rude.back()->get(), answer, 12, MSG_WAITALL), 0);
  EXPECT_STREQ(answer, "HTTP/1.1 200");
}

/// Requests that no browser sends, drawn: nothing crashes, nothing is ordered, nothing but the page
/// is read.
TEST_F(PageServerTest, HostileRequestsGetNothing) {
  serve();
  std::mt19937_64 random(20'261'123);
  const std::vector<std::string> methods = {"GET",   "POST",    "PUT", "DELETE", "OPTIONS",
                                            "TRACE", "CONNECT", "get", "\x01",   ""};
  const std::vector<std::string> paths = {"/",
                                          "/../../../../etc/passwd",
                                          "/%2e%2e/%2e%2e/etc/passwd",
                                          "//etc/passwd",
                                          "/api/../../tokens",
                                          "/orders",
                                          "/api/status/../../state",
                                          "/page.css%00.html",
                                          "/\xff\xfe",
                                          "*",
                                          "http://evil.example/",
                                          "/" + std::string(9'000, 'a'),
                                          "/?" + std::string(9'000, 'b'),
                                          "/api/%",
                                          "/api/status?x=%zz"};
  const std::vector<std::string> headers = {"Host: 127.0.0.1",
                                            "Host: evil.example",
                                            "Content-Length: 99999999999999999999",
                                            "Content-Length: -1",
                                            "Content-Length: 1000000",
                                            "Transfer-Encoding: chunked",
                                            "Authorization: Bearer ",
                                            "Authorization: Basic YTpi",
                                            "Range: bytes=0-18446744073709551615",
                                            "Range: bytes=9-1,5-",
                                            "Origin: null",
                                            "Expect: 100-continue",
                                            "X: " + std::string(20'000, 'x'),
                                            "Connection: keep-alive",
                                            "Accept: text/html",
                                            ": nothing",
                                            "no colon"};
  const std::vector<std::string> bodies = {"",
                                           "order=hold&power_w=0&minutes=30",
                                           "order=hold&token=",
                                           "ffffffffffffffff\r\n",
                                           "\r\n\r\n",
                                           std::string(8'000, '&'),
                                           "token=%00&order=clear",
                                           "order=clear&token=anna"};
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
    EXPECT_THAT(answer, Not(HasSubstr("0123456789abcdef"))) << request.substr(0, 200);
  }
  EXPECT_FALSE(std::filesystem::exists(site_.folder.file("state/hold")));
  EXPECT_FALSE(std::filesystem::exists(site_.folder.file("state/cleared")));
  EXPECT_EQ(get("/").status, 200);
}

}  // namespace
}  // namespace bess
