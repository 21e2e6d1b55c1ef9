// Why a broker cannot be reached is told by its cause: each cause by a real server, or
// a real broker, that has it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "edge/notify/mqtt_client.h"
#include "edge/notify/notify_settings.h"
#include "tests/support/dated_certificate.h"
#include "tests/support/mqtt_broker.h"
#include "tests/support/test_server.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

constexpr long kDayS = DatedCertificate::kDayS;

struct BadCertificate {
  const char* name;
  long from_s, to_s;
  const char* cause;
};

constexpr BadCertificate kBadCertificates[] = {
    {"IP:127.0.0.1", -2 * kDayS, -kDayS, "the server's certificate has expired: renew it there"},
    {"IP:127.0.0.1", kDayS, 2 * kDayS,
     "is not valid yet: is this computer's clock right (timedatectl)?"},
    {"IP:127.0.0.2", -kDayS, kDayS, "is of another name: is it the host that is configured?"},
    {"DNS:localhost", -kDayS, kDayS, "is of another name: is it the host that is configured?"},
};

class MqttTrouble : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(Broker::kProgram)) GTEST_SKIP() << "mosquitto is not installed";
  }
  /// What a message meets at this broker.
  static std::string send(int port, const std::string& ca_file, const std::string& user = "") {
    NotifySettings notify;
    notify.name = "garage";
    MqttSettings& settings = notify.mqtt;
    settings.host = "127.0.0.1";
    settings.port = port;
    settings.ca_file = ca_file;
    settings.user = user;
    settings.password = user.empty() ? "" : "wrong";
    MqttClient client(notify, MqttPresence::kStays);
    client.publish("bess/v1/garage/event", "{}");
    return client.wait_until_sent(std::chrono::milliseconds(1'500)) ? "" : client.find_trouble();
  }
  std::string tls_keys(const DatedCertificate& certificate) const {
    return "allow_anonymous true\ncertfile " + certificate.certificate() + "\nkeyfile " +
           certificate.key() + "\n";
  }
  TemporaryFolder folder_;
};

TEST_F(MqttTrouble, AGoodCertificateIsTaken) {
  const DatedCertificate good("IP:127.0.0.1", -kDayS, kDayS);
  const DatedCertificate other("IP:127.0.0.1", -kDayS, kDayS, "another CA");
  const DatedCertificate renewed("IP:127.0.0.1", -kDayS,
                                 kDayS);  // of the same name, with another key
  Broker broker(folder_, Broker::free_port(), tls_keys(good));
  EXPECT_EQ(send(broker.port(), good.ca()), "");
  EXPECT_THAT(send(broker.port(), other.ca()),
              StartsWith("no connection to the broker: the server's certificate is of no "
                         "authority that is known here: mqtt_ca_file must hold"));
  EXPECT_THAT(
      send(broker.port(), renewed.ca()),
      HasSubstr("is the authority the one that signed the server's certificate? mqtt_ca_file"));
}

TEST_F(MqttTrouble, EachBadCertificateIsToldByItsCause) {
  for (const auto& [name, from_s, to_s, cause] : kBadCertificates) {
    const DatedCertificate bad(name, from_s, to_s);
    Broker broker(folder_, Broker::free_port(), tls_keys(bad));
    EXPECT_THAT(send(broker.port(), bad.ca()), HasSubstr(cause)) << name;
  }
}

TEST_F(MqttTrouble, BrokersThatAreNone) {
  EXPECT_THAT(send(Broker::free_port(), ""), HasSubstr("connection refused"));
  const DatedCertificate good("IP:127.0.0.1", -kDayS, kDayS);
  Broker plain(folder_, Broker::free_port());
  EXPECT_THAT(send(plain.port(), good.ca()), HasSubstr("no TLS there"));
  Broker closed(folder_, Broker::free_port(), "allow_anonymous false\n");
  EXPECT_THAT(send(closed.port(), "", "somebody"), HasSubstr("see mqtt_user, mqtt_password_file"));
  TestServer silent([&silent](TestConnection&, const std::string&) {
    silent.wait_for_end();
    return false;
  });
  EXPECT_THAT(send(silent.port(), ""), HasSubstr("does it speak MQTT there?"));
}

}  // namespace
}  // namespace bess
