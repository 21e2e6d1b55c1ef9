// The download over TLS from servers that are set up wrongly: one line says what, nothing is
// written, and what cannot succeed is asked once.
#include <gmock/gmock.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <thread>

#include "shared/host/child_process.h"
#include "tests/support/dated_certificate.h"
#include "tests/support/market_test_support.h"
#include "tests/support/test_server.h"
#include "workstation/market/feed/elia_fetch.h"

namespace bess {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

constexpr long kDay_s = DatedCertificate::kDayS;
constexpr const char* kBusy = "HTTP/1.1 404 Not Found\r\n";

TestServer::Options with(const DatedCertificate& certificate) {
  return {.certificate = certificate.certificate(), .key = certificate.key()};
}
bool say_404(TestConnection& connection, const std::string&) {
  return connection.answer("", kBusy);
}

/// Takes connections, answers the first byte of each with the same words, and closes it.
class ClosingServer {
 public:
  explicit ClosingServer(std::string words) : fd_(bind_socket(place_)) {
    listen(fd_, 16);
    thread_ = std::thread([this, words = std::move(words)] {
      for (int client = 0; (client = accept(fd_, nullptr, nullptr)) >= 0; close(client)) {
        ++connections_;
        char byte = 0;
        EXPECT_EQ(recv(client, &byte, 1, 0), 1);
        send(client, words.data(), words.size(), MSG_NOSIGNAL);
      }
    });
  }
  ClosingServer(const ClosingServer&) = delete;
  ClosingServer& operator=(const ClosingServer&) = delete;
  ~ClosingServer() {
    shutdown(fd_, SHUT_RDWR);
    thread_.join();
    close(fd_);
  }
  [[nodiscard]] int port() const { return ntohs(place_.sin_port); }
  [[nodiscard]] int connections() const { return connections_; }

 private:
  sockaddr_in place_ = loopback_address();
  int fd_;
  std::atomic<int> connections_ = 0;
  std::thread thread_;
};

class TlsModes : public testing::Test {
 protected:
  ~TlsModes() override { unsetenv("SSL_CERT_FILE"); }

  static std::string url(const char* scheme, int port) {
    return fmt::format("{}://127.0.0.1:{}/api/explore/v2.1", scheme, port);
  }
  std::string error_of(const std::string& base_url) {
    const FetchRequest wanted{.span = {{2023, 3, 25}, {2023, 3, 25}},
                              .out = folder_ / "prices.csv",
                              .base_url = base_url,
                              .now_utc_s = 1'750'000'000,
                              .retry = {},
                              .sleep = [](double, const std::atomic<bool>&) {}};
    const std::atomic<bool> interrupted{false};
    std::string error = user_error_of([&] { fetch_prices(wanted, interrupted); });
    EXPECT_EQ(error.find('\n'), error.npos) << error;
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / ""));
    return error;
  }
  std::string error_of(const DatedCertificate& certificate) {
    const TestServer server(say_404, with(certificate));
    return error_of(url("https", server.port()));
  }
  static void trust(const DatedCertificate& certificate) {
    setenv("SSL_CERT_FILE", certificate.ca().c_str(), 1);
  }

  ScratchFolder folder_;
};

TEST_F(TlsModes, ACertificateThatHoldsIsBelieved) {
  const DatedCertificate certificate("IP:127.0.0.1", -kDay_s, kDay_s);
  trust(certificate);
  EXPECT_THAT(error_of(certificate), HasSubstr("the server answered 404 (1 attempt)"));
}

TEST_F(TlsModes, AnotherName) {
  const DatedCertificate certificate("DNS:elsewhere.example", -kDay_s, kDay_s);
  trust(certificate);
  EXPECT_THAT(error_of(certificate),
              HasSubstr("is of another name: is it the host that is configured? (1 attempt)"));
}

TEST_F(TlsModes, AnotherTime) {
  const DatedCertificate old("IP:127.0.0.1", -2 * kDay_s, -kDay_s);
  trust(old);
  EXPECT_THAT(error_of(old), HasSubstr("has expired: renew it there"));
  const DatedCertificate early("IP:127.0.0.1", kDay_s, 2 * kDay_s);
  trust(early);
  EXPECT_THAT(error_of(early), HasSubstr("is not valid yet: is this computer's clock right"));
}

TEST_F(TlsModes, AnAuthorityThatNobodyKnows) {
  const DatedCertificate certificate("IP:127.0.0.1", -kDay_s, kDay_s);
  EXPECT_THAT(error_of(certificate), HasSubstr("is of no authority that is known here"));
  trust(DatedCertificate("IP:127.0.0.1", -kDay_s, kDay_s, "another CA"));
  EXPECT_THAT(error_of(certificate),
              HasSubstr("SSL_CERT_FILE may name a file of others (1 attempt)"))
      << "its folder is gone";
}

TEST_F(TlsModes, NoTls) {
  const ClosingServer plain("HTTP/1.1 400 Bad Request\r\n\r\n");
  EXPECT_THAT(error_of(url("https", plain.port())),
              HasSubstr("no TLS there: is the port right, does the server speak TLS? (1 "));
  const DatedCertificate certificate("IP:127.0.0.1", -kDay_s, kDay_s);
  const TestServer tls(say_404, with(certificate));
  EXPECT_THAT(error_of(url("http", tls.port())),
              AnyOf(HasSubstr("is it https:// instead of http://?"),
                    HasSubstr("http:// or https:// right?")));
}

TEST_F(TlsModes, ClosedInTheHandshake) {
  const ClosingServer server("");
  EXPECT_THAT(error_of(url("https", server.port())),
              HasSubstr("in the TLS handshake: is there no TLS there, is the port right? (3 "));
  EXPECT_EQ(server.connections(), 3);
}

TEST_F(TlsModes, RefusedInTheHandshake) {
  const TestServer server(say_404, {.certificate = "none", .key = "none"});
  EXPECT_THAT(error_of(url("https", server.port())),
              HasSubstr("refused the TLS handshake: it knows no common version or cipher (1 "));
}

/// As a user runs it: the program's exit code, one line, and no file.
TEST_F(TlsModes, TheProgramEndsWithOneLine) {
  const DatedCertificate certificate("IP:127.0.0.1", -2 * kDay_s, -kDay_s);
  trust(certificate);
  const TestServer server(say_404, with(certificate));
  const std::string address = url("https", server.port());
  const std::string out = (folder_ / "out").string();
  const std::vector<std::vector<std::string>> commands{
      {"prices", "fetch", "--from", "2023-03-01", "--to", "2023-03-01", "--base-url", address,
       "--out", out},
      {"prices", "record", "--out", out, "--for", "20s", "--url", address}};
  for (std::vector<std::string> arguments : commands) {
    arguments.insert(arguments.begin(), BESS_TRAIN_PROGRAM);
    ChildProcess program(arguments);
    const std::string output = program.read_all();
    EXPECT_EQ(program.wait(), 1) << output;
    EXPECT_THAT(output, HasSubstr("the server's certificate has expired"));
    EXPECT_EQ(std::ranges::count(output, '\n'), 1) << output;
    EXPECT_TRUE(std::filesystem::is_empty(folder_ / ""));
  }
}

}  // namespace
}  // namespace bess
