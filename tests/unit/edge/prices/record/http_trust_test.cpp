// Which price URLs others could write: a table.
#include "edge/prices/record/http_trust.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

TEST(HttpTrust, LoopbackIsANumberOfThisMachine) {
  const struct {
    const char* url;
    UrlTransport transport;
  } table[] = {
      {"https://a.example/x", UrlTransport::kSecure},
      {"https://127.0.0.1/x", UrlTransport::kSecure},
      {"http://127.0.0.1:8080/x", UrlTransport::kLoopback},
      {"http://127.255.0.9/", UrlTransport::kLoopback},
      {"http://127.1/", UrlTransport::kLoopback},  // the same number
      {"http://[::1]:8080/x", UrlTransport::kLoopback},
      {"http://[0:0:0:0:0:0:0:1]/x", UrlTransport::kLoopback},
      {"http://localhost/x", UrlTransport::kOpen},  // what it is, the resolver says
      {"http://a.example/x", UrlTransport::kOpen},
      {"http://192.168.1.9/x", UrlTransport::kOpen},
      {"http://127.0.0.1.example/x", UrlTransport::kOpen},
      {"http://127.0.0.1@a.example/x", UrlTransport::kOpen},
      {"http://[fe80::1]/x", UrlTransport::kOpen},
      {"ftp://127.0.0.1/", UrlTransport::kUnusable},
      {"http://", UrlTransport::kUnusable},
      {"https://user:pa/ss@a.example/", UrlTransport::kUnusable},
      {"", UrlTransport::kUnusable},
  };
  for (const auto& row : table) EXPECT_EQ(transport_of(row.url), row.transport) << row.url;
}

TEST(HttpTrust, ALoginIsWhatStandsBeforeTheHost) {
  EXPECT_TRUE(holds_login("http://user:password@a.example/"));
  EXPECT_TRUE(holds_login("http://user@a.example"));
  EXPECT_FALSE(holds_login("http://a.example/u@v?q=a@b"));
  EXPECT_FALSE(holds_login("http://a.example"));
}

}  // namespace
}  // namespace bess
