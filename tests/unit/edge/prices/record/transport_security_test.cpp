// Price URLs that others could write: a table.
#include "edge/prices/record/transport_security.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

namespace bess {
namespace {

TEST(HttpTrust, LoopbackIsANumberOfThisMachine) {
  const std::pair<UrlTransport, std::vector<const char*>> table[] = {
      {UrlTransport::kSecure, {"https://a.example/x", "https://127.0.0.1/x"}},
      // 127.1 is the same number.
      {UrlTransport::kLoopback,
       {"http://127.0.0.1:8080/x", "http://127.255.0.9/", "http://127.1/", "http://[::1]:8080/x",
        "http://[0:0:0:0:0:0:0:1]/x"}},
      // The resolver defines localhost.
      {UrlTransport::kOpen,
       {"http://localhost/x", "http://a.example/x", "http://192.168.1.9/x",
        "http://127.0.0.1.example/x", "http://127.0.0.1@a.example/x", "http://[fe80::1]/x"}},
      {UrlTransport::kUnusable,
       {"ftp://127.0.0.1/", "http://", "https://user:pa/ss@a.example/", ""}},
  };
  for (const auto& [transport, urls] : table) {
    for (const char* url : urls) EXPECT_EQ(transport_of(url), transport) << url;
  }
}

TEST(HttpTrust, ALoginIsTheTextBeforeTheHost) {
  EXPECT_TRUE(holds_login("http://user:password@a.example/"));
  EXPECT_TRUE(holds_login("http://user@a.example"));
  EXPECT_FALSE(holds_login("http://a.example/u@v?q=a@b"));
  EXPECT_FALSE(holds_login("http://a.example"));
}

}  // namespace
}  // namespace bess
