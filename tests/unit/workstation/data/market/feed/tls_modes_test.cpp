// Download over TLS from misconfigured servers: one line names the cause, nothing is written, and
// requests that cannot succeed are made once.
#include <gmock/gmock.h>

#include <atomic>
#include <cstdlib>
#include <set>
#include <thread>

#include "tests/support/dated_certificate.h"
#include "tests/support/market_test_support.h"
#include "tests/support/test_server.h"
#include "tests/support/tokens.h"
#include "workstation/data/market/feed/elia_fetch.h"

namespace bess {
namespace {

constexpr long kDay_s = DatedCertificate::kDayS;

TestServer::Options with(const DatedCertificate& certificate) {
  return {.certificate = certificate.certificate(), .key = certificate.key()};
}
bool say_404(TestConnection& connection, const std::string&) {
  return connection.answer("", "HTTP/1.1 404 Not Found\r\n");
}

/// Accepts connections, answers the first byte of each with the same text, and closes it.
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

TEST_F(TlsModes, AValidCertificateIsAccepted) {
  const DatedCertificate certificate("IP:127.0.0.1", -kDay_s, kDay_s);
  trust(certificate);
  EXPECT_THAT(error_of(certificate), Names("404 1 ods046"));
}

/// Each has a distinct message.
TEST_F(TlsModes, CertificatesThatDoNotHold) {
  std::set<std::string> told;
  const auto refused = [&](const DatedCertificate& certificate, const char* names) {
    const std::string error = error_of(certificate);
    EXPECT_THAT(error, Names("1 ods046 " + std::string(names)));
    told.insert(error.substr(0, error.find("ods046")));
  };
  const DatedCertificate other("DNS:elsewhere.example", -kDay_s, kDay_s);
  trust(other);
  refused(other, "");
  const DatedCertificate old("IP:127.0.0.1", -2 * kDay_s, -kDay_s);
  trust(old);
  refused(old, "timedatectl");
  const DatedCertificate early("IP:127.0.0.1", kDay_s, 2 * kDay_s);
  trust(early);
  refused(early, "timedatectl");
  const DatedCertificate good("IP:127.0.0.1", -kDay_s, kDay_s);
  unsetenv("SSL_CERT_FILE");
  refused(good, "");
  trust(DatedCertificate("IP:127.0.0.1", -kDay_s, kDay_s, "another CA"));  // its folder is gone
  refused(good, "SSL_CERT_FILE");
  EXPECT_EQ(told.size(), 5u);
}

TEST_F(TlsModes, NoTlsOnOneSide) {
  const ClosingServer plain("HTTP/1.1 400 Bad Request\r\n\r\n");
  EXPECT_THAT(error_of(url("https", plain.port())), Names("TLS 1 ods046"));
  const DatedCertificate certificate("IP:127.0.0.1", -kDay_s, kDay_s);
  const TestServer tls(say_404, with(certificate));
  EXPECT_THAT(error_of(url("http", tls.port())), Names("http:// https:// ods046"));
}

TEST_F(TlsModes, TheHandshakeFails) {
  const ClosingServer closing("");
  EXPECT_THAT(error_of(url("https", closing.port())), Names("TLS 3 ods046"));
  EXPECT_EQ(closing.connections(), 3);
  const TestServer refusing(say_404, {.certificate = "none", .key = "none"});
  EXPECT_THAT(error_of(url("https", refusing.port())), Names("TLS 1 ods046"));
}

}  // namespace
}  // namespace bess
