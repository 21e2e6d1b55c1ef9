// HTTP client with hosts of several addresses, some of them dead, redirects, and servers that ask
// for fewer requests; on a fake resolver.
#include "shared/host/http_client.h"

#include <gmock/gmock.h>

#include <chrono>

#include "tests/support/dated_certificate.h"
#include "tests/support/fake_resolver.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using Kind = HttpOutcome::Kind;

constexpr const char* kName = "prices.example";

const DatedCertificate& ca() {
  static const DatedCertificate authority(std::string("DNS:") + kName);
  return authority;
}

TestServer::Options tls_at(const char* address, std::uint16_t port = 0) {
  return {.address = address, .port = port, .certificate = ca().certificate(), .key = ca().key()};
}

HttpRequest request_of(const TestServer& server, const std::string& path = "/") {
  return {.url = std::string("https://") + kName + ":" + std::to_string(server.port()) + path,
          .limits = {.deadline_s = 4},
          .ca_file = ca().ca()};
}

HttpOutcome get(const HttpRequest& request) {
  return http_request(request, [] { return false; });
}

double seconds_of(const std::function<void()>& action) {
  const auto begin = std::chrono::steady_clock::now();
  action();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

bool good_answer(TestConnection& connection, const std::string&) { return connection.answer("[]"); }
bool no_answer(TestConnection&, const std::string&) { return false; }

std::string url_of(const TestServer& server) {
  return "http://127.0.0.1:" + std::to_string(server.port()) + "/";
}

/// Accepts a request and gives no answer until a time-out.
class SilentServer {
 public:
  explicit SilentServer(std::uint16_t port = 0, const char* address = "127.0.0.1")
      : server_(
            [this](TestConnection&, const std::string&) {
              server_.wait_for_end();
              return false;
            },
            tls_at(address, port)) {}
  [[nodiscard]] const TestServer& server() const { return server_; }

 private:
  TestServer server_;
};

/// Accepts connections, as the kernel does, without an answer.
class SilentPlace {
 public:
  SilentPlace(const char* address, std::uint16_t port) {
    sockaddr_in place = loopback_address(port, address);
    fd_ = bind_socket(place);
    listen(fd_, 16);
  }
  SilentPlace(const SilentPlace&) = delete;
  SilentPlace& operator=(const SilentPlace&) = delete;
  ~SilentPlace() { close(fd_); }

 private:
  int fd_;
};

class HostOfManyAddresses : public ::testing::Test {
 protected:
  static void use(const std::vector<std::string>& addresses) {
    fake_resolver::set(kName, addresses);
  }
  TestServer good_{good_answer, tls_at("127.0.0.3")};
};

TEST_F(HostOfManyAddresses, OneThatConnectsAndHangsInTlsCostsOneTimeOut) {
  use({"127.0.0.1", "127.0.0.3"});
  const SilentPlace silent("127.0.0.1", good_.port());
  EXPECT_EQ(get(request_of(good_)).kind, Kind::kDone);
  const double again_s = seconds_of([&] { EXPECT_EQ(get(request_of(good_)).kind, Kind::kDone); });
  EXPECT_LT(again_s, 1.5);  // the time to connect is 2 s
}

TEST_F(HostOfManyAddresses, OneThatBreaksOffIsSkipped) {
  use({"127.0.0.1", "127.0.0.2", "127.0.0.3"});
  TestServer mute(no_answer, tls_at("127.0.0.1", good_.port()));
  const TestServer plain(
      no_answer, {.address = "127.0.0.2", .port = good_.port(), .certificate = "", .key = ""});
  EXPECT_EQ(get(request_of(good_)).kind, Kind::kDone);
  EXPECT_EQ(mute.requests(), 1);
}

TEST_F(HostOfManyAddresses, OneThatTakesTheRequestAndIsSilentIsLeftByTheNext) {
  use({"127.0.0.1", "127.0.0.3"});
  const SilentServer silent(good_.port());
  EXPECT_NE(get(request_of(good_)).kind, Kind::kDone);
  EXPECT_EQ(get(request_of(good_)).kind, Kind::kDone);
}

/// The address of a kept connection would answer again.
TEST_F(HostOfManyAddresses, OneThatIsAGatewayWithoutServerIsSkipped) {
  use({"127.0.0.1", "127.0.0.3"});
  TestServer gateway(
      [](TestConnection& connection, const std::string&) {
        return connection.answer("", "HTTP/1.1 502 Bad Gateway\r\n");
      },
      tls_at("127.0.0.1", good_.port()));
  EXPECT_EQ(get(request_of(good_)).kind, Kind::kDone);
  EXPECT_EQ(gateway.requests(), 1);
}

TEST_F(HostOfManyAddresses, EachIsTriedInTurn) {
  use({"127.0.0.1", "127.0.0.2", "127.0.0.3"});
  const SilentServer first(good_.port());
  const SilentServer second(good_.port(), "127.0.0.2");
  HttpRequest request = request_of(good_);
  request.limits.deadline_s = 1;
  EXPECT_NE(get(request).kind, Kind::kDone);
  EXPECT_NE(get(request).kind, Kind::kDone);
  EXPECT_EQ(get(request).kind, Kind::kDone);
}

TEST_F(HostOfManyAddresses, AHostThatMovedIsFound) {
  use({"127.0.0.3"});
  EXPECT_EQ(get(request_of(good_)).kind, Kind::kDone);
  TestServer elsewhere(good_answer, tls_at("127.0.0.4"));
  use({"127.0.0.4"});
  EXPECT_EQ(get(request_of(elsewhere)).kind, Kind::kDone);
}

TEST(HttpClient, SecretsStayWithTheirHostAndTls) {
  fake_resolver::set(kName, {"127.0.0.1"});
  std::string seen;
  TestServer elsewhere([&](TestConnection& connection, const std::string& request) {
    seen = request;
    return connection.answer("[]");
  });
  std::string target;
  const auto redirect = [&](TestConnection& connection, const std::string&) {
    return connection.answer("", "HTTP/1.1 302 Found\r\nLocation: " + target + "\r\n");
  };
  TestServer server(
      [&](TestConnection& connection, const std::string& request) {
        if (request.starts_with("GET /here")) {
          EXPECT_THAT(request, HasSubstr("X-Key: secret"));
          return connection.answer("[]");
        }
        return redirect(connection, request);
      },
      tls_at("127.0.0.1"));
  HttpRequest request = request_of(server, "/from");
  request.headers = {"X-Key: secret"};
  target = "/here";
  EXPECT_EQ(get(request).kind, Kind::kDone);
  target = url_of(elsewhere);
  EXPECT_EQ(get(request).status, 302);  // from https to http
  EXPECT_EQ(elsewhere.requests(), 0);
  const TestServer plain(redirect);
  request.url = url_of(plain);
  EXPECT_EQ(get(request).kind, Kind::kDone);
  EXPECT_EQ(elsewhere.requests(), 1);
  EXPECT_THAT(seen, ::testing::Not(HasSubstr("secret")));
  target = request.url;
  EXPECT_EQ(get(request).status, 302);  // in a loop
}

TEST(HttpClient, AServerThatAsksForLessIsObeyed) {
  TestServer server([](TestConnection& connection, const std::string&) {
    return connection.answer("slow down", "HTTP/1.1 429 No\r\nRetry-After: 600\r\n");
  });
  const HttpOutcome outcome = get({.url = url_of(server)});
  EXPECT_EQ(outcome.kind, Kind::kBusy);
  EXPECT_EQ(outcome.status, 429);
  EXPECT_EQ(outcome.wait_s, 600);
}

TEST(HttpClient, StopsWhenItIsAskedTo) {
  fake_resolver::set(kName, {"127.0.0.1"});
  const SilentServer silent;
  int asked = 0;
  HttpOutcome outcome;
  const double took_s = seconds_of(
      [&] { outcome = http_request(request_of(silent.server()), [&] { return ++asked > 1; }); });
  EXPECT_EQ(outcome.kind, Kind::kInterrupted);
  EXPECT_LT(took_s, 3);
}

TEST(HttpClient, AnUnknownNameIsReported) {
  fake_resolver::set("gone.example", {});
  EXPECT_EQ(get({.url = "http://gone.example/", .limits = {.deadline_s = 4}}).kind,
            Kind::kUnreachable);
}

}  // namespace
}  // namespace bess
