// The HTTP client against servers that misbehave in every way a network offers, over TLS and in
// clear. This program runs on the static arena and on a fake resolver.
#include "edge/prices/http_client.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <stdlib.h>

#include <chrono>

#include "edge/memory/static_arena.h"
#include "tests/support/fake_resolver.h"
#include "tests/support/test_server.h"
#include "tests/support/throwaway_ca.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr const char* kName = "prices.example";

const ThrowawayCa& ca() {
  static const ThrowawayCa authority(std::string("DNS:") + kName);
  return authority;
}

TestServer::Options tls_options() { return {.certificate = ca().certificate(), .key = ca().key()}; }

HttpSettings settings_for(const std::string& url) {
  HttpSettings settings;
  settings.url = FixedText<511>(url);
  settings.ca_file = FixedText<255>(ca().ca());
  settings.timeout_ms = 4'000;
  return settings;
}

std::string url_of(const TestServer& server, const std::string& path = "/") {
  return "http://127.0.0.1:" + std::to_string(server.port()) + path;
}

std::string tls_url_of(const TestServer& server, const std::string& path = "/") {
  return std::string("https://") + kName + ":" + std::to_string(server.port()) + path;
}

Status get(const HttpSettings& settings) {
  HttpClient client(settings);
  std::string_view body;
  return client.get(body);
}

bool good_answer(TestConnection& connection, const std::string&) { return connection.answer("[]"); }

class HttpClientTest : public ::testing::Test {
 protected:
  void SetUp() override {
    fake_resolver::set(kName, {"127.0.0.1"});
    fake_resolver::set_delay_ms(0);
  }
};

TEST_F(HttpClientTest, ReadsOverTlsByNameAndLeavesNoLookupToLibcurl) {
  TestServer server(good_answer, tls_options());
  const int before = fake_resolver::lookups(kName);
  HttpClient client(settings_for(tls_url_of(server)));
  for (int i = 0; i < 3; ++i) {
    std::string_view body;
    ASSERT_EQ(client.get(body), Status::kOk);
    EXPECT_EQ(body, "[]");
  }
  EXPECT_EQ(fake_resolver::lookups(kName), before + 1);
}

TEST_F(HttpClientTest, AnUntrustedOrWrongCertificateIsRefused) {
  TestServer server(good_answer, tls_options());
  const ThrowawayCa other("DNS:prices.example");
  HttpSettings settings = settings_for(tls_url_of(server));
  settings.ca_file = FixedText<255>(other.ca());
  EXPECT_EQ(get(settings), Status::kTlsRefused);
  fake_resolver::set("other.example", {"127.0.0.1"});
  settings = settings_for("https://other.example:" + std::to_string(server.port()) + "/");
  EXPECT_EQ(get(settings), Status::kTlsRefused);
  settings.ca_file = "/nonexistent";
  EXPECT_EQ(get(settings), Status::kTlsRefused);
  EXPECT_EQ(server.requests(), 0);
}

TEST_F(HttpClientTest, EveryAddressIsTriedAndAMovedHostIsFound) {
  fake_resolver::set(kName, {"::1", "127.0.0.9", "127.0.0.1"});
  auto server = std::make_unique<TestServer>(good_answer, tls_options());
  const std::uint16_t port = server->port();
  HttpClient client(settings_for(tls_url_of(*server)));
  std::string_view body;
  ASSERT_EQ(client.get(body), Status::kOk);
  server.reset();
  EXPECT_EQ(client.get(body), Status::kNotConnected);
  TestServer::Options moved = tls_options();
  moved.address = "127.0.0.2";
  moved.port = port;
  TestServer elsewhere(good_answer, moved);
  EXPECT_EQ(elsewhere.port(), port);
  fake_resolver::set(kName, {"127.0.0.2"});
  EXPECT_EQ(client.get(body), Status::kOk);
}

TEST_F(HttpClientTest, ASilentResolverLeavesTheLastGoodAddresses) {
  TestServer server(
      [](TestConnection& connection, const std::string&) {
        connection.answer("[]");
        return false;  // every request connects anew
      },
      tls_options());
  HttpSettings settings = settings_for(tls_url_of(server));
  settings.resolve_every_s = 0;
  HttpClient client(settings);
  fake_resolver::set(kName, {});
  const int before = fake_resolver::lookups(kName);
  std::string_view body;
  for (int i = 0; i < 5; ++i) EXPECT_EQ(client.get(body), Status::kOk);
  EXPECT_EQ(fake_resolver::lookups(kName), before + 1);  // and is not asked all the time
}

TEST_F(HttpClientTest, AnUnknownNameIsSaidSoUntilItIsKnown) {
  TestServer server(good_answer, tls_options());
  fake_resolver::set(kName, {});
  HttpClient client(settings_for(tls_url_of(server)));
  std::string_view body;
  EXPECT_EQ(client.get(body), Status::kNameUnresolved);
  fake_resolver::set(kName, {"127.0.0.1"});
  EXPECT_EQ(client.get(body), Status::kOk);
}

struct Misbehaviour {
  const char* name;
  TestServer::Handler handler;
  Status status;
};

TEST_F(HttpClientTest, EveryMisbehaviourEndsInTimeWithItsStatus) {
  const auto say = [](const std::string& text) {
    return [text](TestConnection& connection, const std::string&) {
      connection.send(text);
      return false;
    };
  };
  TestServer* current = nullptr;
  const auto drip = [&](TestConnection& connection, const std::string&) {
    connection.send("HTTP/1.1 200 OK\r\nX: ");
    while (!current->is_stopping() && connection.send("X")) usleep(20'000);
    return false;
  };
  const auto hang = [&](TestConnection&, const std::string&) {
    current->wait_for_end();
    return false;
  };
  const std::string head = "HTTP/1.1 200 OK\r\n";
  const Misbehaviour table[] = {
      {"says nothing", hang, Status::kTimeout},
      {"one header byte at a time", drip, Status::kTimeout},
      {"closes at once", say(""), Status::kNotConnected},
      {"half a header", say("HTTP/1.1 200 O"), Status::kNotConnected},
      {"half a body", say(head + "Content-Length: 100\r\n\r\n[{"), Status::kNotConnected},
      {"broken chunks", say(head + "Transfer-Encoding: chunked\r\n\r\nzz\r\n"),
       Status::kNotConnected},
      {"huge body", say(head + "\r\n" + std::string(100'000, ' ')), Status::kTooLarge},
      {"huge header line", say(head + "X: " + std::string(99'000, 'y') + "\r\n\r\n[]"),
       Status::kTooLarge},
      {"no HTTP", say("SSH-2.0-OpenSSH_9.2\r\n"), Status::kHttpError},
      {"not found", say("HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n"), Status::kHttpError},
      {"no content", say("HTTP/1.1 204 No Content\r\n\r\n"), Status::kHttpError},
      {"too many requests", say("HTTP/1.1 429 Slow\r\nContent-Length: 0\r\n\r\n"),
       Status::kHttpError},
  };
  for (const Misbehaviour& row : table) {
    TestServer server(row.handler);
    current = &server;
    HttpSettings settings = settings_for(url_of(server));
    settings.timeout_ms = 500;
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(status_name(get(settings)), status_name(row.status)) << row.name;
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << row.name;
  }
}

TEST_F(HttpClientTest, AManyLineHeaderIsBoundedToo) {
  TestServer server([](TestConnection& connection, const std::string&) {
    std::string lines = "HTTP/1.1 200 OK\r\n";
    for (int i = 0; i < 1'000; ++i)
      lines += "X-" + std::to_string(i) + ": " + std::string(90, 'y') + "\r\n";
    connection.send(lines + "\r\n[]");
    return false;
  });
  EXPECT_EQ(get(settings_for(url_of(server))), Status::kTooLarge);
}

TEST_F(HttpClientTest, AServerThatDiesAndComesBackIsFoundAgain) {
  auto server = std::make_unique<TestServer>(good_answer, tls_options());
  TestServer::Options same = tls_options();
  same.port = server->port();
  HttpClient client(settings_for(tls_url_of(*server)));
  std::string_view body;
  EXPECT_EQ(client.get(body), Status::kOk);
  server.reset();
  for (int i = 0; i < 3; ++i) EXPECT_EQ(client.get(body), Status::kNotConnected);
  server = std::make_unique<TestServer>(good_answer, same);
  EXPECT_EQ(client.get(body), Status::kOk);
}

TestServer::Handler redirect_to(const std::string& target) {
  return [target](TestConnection& connection, const std::string&) {
    return connection.answer("", "HTTP/1.1 302 Found\r\nLocation: " + target + "\r\n");
  };
}

TEST_F(HttpClientTest, RedirectsAreFewAndToHttpsOnly) {
  TestServer good(good_answer, tls_options());
  TestServer once(redirect_to(tls_url_of(good)), tls_options());
  EXPECT_EQ(get(settings_for(tls_url_of(once))), Status::kOk);
  TestServer clear(good_answer);
  TestServer downgrade(redirect_to(url_of(clear)), tls_options());
  EXPECT_EQ(get(settings_for(tls_url_of(downgrade))), Status::kHttpError);
  EXPECT_EQ(clear.requests(), 0);
  TestServer file(redirect_to("file:///etc/hostname"), tls_options());
  EXPECT_EQ(get(settings_for(tls_url_of(file))), Status::kHttpError);
  for (const char* const status : {"299 Odd", "400 Bad Request"}) {  // a place to go, no redirect
    TestServer other(
        [&](TestConnection& connection, const std::string&) {
          return connection.answer(
              "", std::string("HTTP/1.1 ") + status + "\r\nLocation: " + tls_url_of(good) + "\r\n");
        },
        tls_options());
    const int before = good.requests();
    EXPECT_EQ(get(settings_for(tls_url_of(other))), Status::kHttpError) << status;
    EXPECT_EQ(good.requests(), before) << status;
  }
  TestServer loop(redirect_to("/again"), tls_options());  // to itself
  EXPECT_EQ(get(settings_for(tls_url_of(loop))), Status::kHttpError);
  EXPECT_EQ(loop.requests(), 1 + HttpClient::kRedirectsMax);
  TestServer nowhere(redirect_to("https://unknown.example/"), tls_options());
  EXPECT_EQ(get(settings_for(tls_url_of(nowhere))), Status::kNameUnresolved);
  // A numeric host was started without preparing for lookups: it may not lead to a name.
  TestServer numeric(redirect_to(tls_url_of(good)));
  const int before = fake_resolver::lookups(kName);
  EXPECT_EQ(get(settings_for(url_of(numeric))), Status::kNameUnresolved);
  EXPECT_EQ(fake_resolver::lookups(kName), before);
}

TEST_F(HttpClientTest, SecretHeadersReachTheConfiguredHostAndNoOther) {
  std::string at_home;
  std::string elsewhere;
  TestServer other(
      [&](TestConnection& connection, const std::string& request) {
        elsewhere = request;
        return connection.answer("[]");
      },
      tls_options());
  TestServer home(
      [&](TestConnection& connection, const std::string& request) {
        at_home = request;
        return redirect_to(tls_url_of(other))(connection, request);
      },
      tls_options());
  HttpSettings settings = settings_for(tls_url_of(home, "/rows?token=t0"));
  settings.headers = "X-Api-Key: k1\nAuthorization: Bearer b2";
  EXPECT_EQ(get(settings), Status::kOk);
  EXPECT_THAT(at_home, HasSubstr("X-Api-Key: k1\r\n"));
  EXPECT_THAT(at_home, HasSubstr("Authorization: Bearer b2\r\n"));
  EXPECT_THAT(at_home, HasSubstr("Accept: application/json\r\n"));
  EXPECT_THAT(elsewhere, HasSubstr("GET / HTTP/1.1"));
  for (const char* secret : {"k1", "b2", "t0"}) EXPECT_THAT(elsewhere, Not(HasSubstr(secret)));
}

TEST_F(HttpClientTest, ProxiesOfTheEnvironmentAreIgnored) {
  TestServer server(good_answer);
  for (const char* name : {"http_proxy", "https_proxy", "ALL_PROXY"}) {
    setenv(name, "http://127.0.0.1:1", 1);
  }
  EXPECT_EQ(get(settings_for(url_of(server))), Status::kOk);
  for (const char* name : {"http_proxy", "https_proxy", "ALL_PROXY"}) unsetenv(name);
}

TEST_F(HttpClientTest, AUrlWithoutHostFailsEveryTime) {
  EXPECT_NE(get(settings_for("http://")), Status::kOk);
}

#ifndef BESS_SANITIZED  // there the malloc family is the sanitizer's
/// Leaves at most `bytes` in one piece, in blocks that `give_back` frees.
std::vector<void*> exhaust_arena(std::size_t block_bytes) {
  std::vector<void*> blocks;
  blocks.reserve(100'000);
  for (std::size_t size = 1 << 20; size >= block_bytes; size /= 2) {
    while (void* block = malloc(size)) blocks.push_back(block);
  }
  return blocks;
}

TEST_F(HttpClientTest, AnExhaustedArenaFailsTheFetchAndNothingElse) {
  // A server of its own process: it must not want for the same memory.
  const TemporaryFolder folder;
  const std::string rows =
      folder.write("rows", "HTTP/1.0 200 OK\r\nContent-Type: application/json\r\n\r\n[]");
  ChildProcess server({"/bin/sh", "-c",
                       "cd " + folder.file("") +
                           " && exec openssl s_server -accept 127.0.0.1:0 -HTTP -cert " +
                           ca().certificate() + " -key " + ca().key()});
  std::string line = server.read_line();
  while (!line.empty() && line.find("ACCEPT") == std::string::npos) line = server.read_line();
  const std::string port = line.substr(line.rfind(':') + 1);
  HttpClient client(settings_for(std::string("https://") + kName + ":" + port + "/rows"));
  std::string_view body;
  EXPECT_EQ(client.get(body), Status::kOk) << line;
  for (const std::size_t block_bytes : {16'384, 1'024, 32}) {
    const std::vector<void*> blocks = exhaust_arena(block_bytes);
    const Status status = client.get(body);
    for (void* block : blocks) free(block);
    EXPECT_EQ(status_name(status), status_name(Status::kNoMemory)) << block_bytes;
    EXPECT_EQ(client.get(body), Status::kOk) << block_bytes;
  }
}
#endif

}  // namespace
}  // namespace bess
