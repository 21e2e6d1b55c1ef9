// What a name resolves to, as libcurl is told it: by a resolver of the test's own.
#include "edge/prices/host_addresses.h"

#include <gtest/gtest.h>

#include <string>

#include "shared/scaled_clock.h"
#include "tests/support/fake_resolver.h"

namespace bess {
namespace {

constexpr const char* kHost = "prices.example";
constexpr std::int64_t kSecondNs = kNanosecondsPerSecond;

HostAddresses of(const char* url) {
  HostAddresses host;
  EXPECT_EQ(host.set_url(url), Status::kOk);
  return host;
}

TEST(HostAddresses, TheEntryHasEveryAddressInItsOrder) {
  HostAddresses host = of("https://prices.example/rows");
  EXPECT_STREQ(host.entry(), "");
  fake_resolver::set(kHost, {"192.0.2.1"});
  EXPECT_EQ(host.refresh(0, 60), Status::kOk);
  EXPECT_STREQ(host.entry(), "prices.example:443:192.0.2.1");
  fake_resolver::set(kHost, {"2001:db8::1", "192.0.2.2", "192.0.2.3"});
  EXPECT_EQ(host.refresh(60 * kSecondNs, 60), Status::kOk);
  EXPECT_STREQ(host.entry(), "prices.example:443:[2001:db8::1],192.0.2.2,192.0.2.3");
}

TEST(HostAddresses, AskedAgainAfterItsTimeOrARetryAndNotBefore) {
  HostAddresses host = of("http://prices.example:8080/rows");
  fake_resolver::set(kHost, {"192.0.2.1"});
  const int before = fake_resolver::lookups(kHost);
  const auto asked = [&](std::int64_t at_ns) {
    EXPECT_EQ(host.refresh(at_ns, 100), Status::kOk);
    return fake_resolver::lookups(kHost) - before;
  };
  EXPECT_EQ(asked(0), 1);
  EXPECT_EQ(asked(100 * kSecondNs - 1), 1);
  EXPECT_EQ(asked(100 * kSecondNs), 2);
  fake_resolver::set(kHost, {});  // what was known stays, and is asked for sooner
  EXPECT_EQ(asked(200 * kSecondNs), 3);
  EXPECT_STREQ(host.entry(), "prices.example:8080:192.0.2.1");
  EXPECT_EQ(asked((200 + HostAddresses::kRetryS) * kSecondNs - 1), 3);
  EXPECT_EQ(asked((200 + HostAddresses::kRetryS) * kSecondNs), 4);
  host.expire();
  EXPECT_EQ(asked((201 + HostAddresses::kRetryS) * kSecondNs), 5);
}

TEST(HostAddresses, ANameThatWasNeverKnownIsAskedForEachTime) {
  HostAddresses host = of("https://nobody.example/");
  for (int i = 1; i <= 3; ++i) {
    EXPECT_EQ(host.refresh(i, 60), Status::kNameUnresolved);
    EXPECT_EQ(fake_resolver::lookups("nobody.example"), i);
    EXPECT_STREQ(host.entry(), "");
  }
}

TEST(HostAddresses, MoreThanTheEntryHoldsAreLeftOut) {
  HostAddresses host = of("https://prices.example/");
  const std::string long_one = "2001:db8:1111:2222:3333:4444:5555:6666";
  fake_resolver::set(kHost, std::vector<std::string>(40, long_one));
  EXPECT_EQ(host.refresh(0, 60), Status::kOk);
  const std::string entry = host.entry();
  EXPECT_LE(entry.size(), 1'023U);
  EXPECT_GT(entry.size(), 1'023U - long_one.size() - 3);
  EXPECT_TRUE(entry.ends_with(",[" + long_one + "]")) << entry;
}

}  // namespace
}  // namespace bess
