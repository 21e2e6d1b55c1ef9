// Broker errors are reported by cause: each cause by a real server or broker that has it.
#include <gmock/gmock.h>

#include <filesystem>
#include <set>

#include "edge/companions/notify/mqtt_client.h"
#include "edge/companions/notify/notify_settings.h"
#include "tests/support/dated_certificate.h"
#include "tests/support/mqtt_broker.h"
#include "tests/support/test_server.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr long kDayS = DatedCertificate::kDayS;

class MqttTrouble : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(Broker::kProgram)) GTEST_SKIP() << "mosquitto is not installed";
  }
  /// Result of a message to this broker.
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

TEST_F(MqttTrouble, AGoodCertificateIsAcceptedAndEachBadOneReportedByItsCause) {
  const DatedCertificate good("IP:127.0.0.1", -kDayS, kDayS);
  const DatedCertificate other("IP:127.0.0.1", -kDayS, kDayS, "another CA");
  const DatedCertificate renewed("IP:127.0.0.1", -kDayS, kDayS);  // of the same name, another key
  Broker broker(folder_, free_port(), tls_keys(good));
  EXPECT_EQ(send(broker.port(), good.ca()), "");
  std::set<std::string> reported = {send(broker.port(), other.ca()),
                                    send(broker.port(), renewed.ca())};
  for (const std::string& trouble : reported) EXPECT_THAT(trouble, Names("mqtt_ca_file"));
  const DatedCertificate expired("IP:127.0.0.1", -2 * kDayS, -kDayS);
  const DatedCertificate early("IP:127.0.0.1", kDayS, 2 * kDayS);
  const DatedCertificate foreign("IP:127.0.0.2", -kDayS, kDayS);
  const DatedCertificate named("DNS:localhost", -kDayS, kDayS);
  for (const DatedCertificate* bad : {&expired, &early, &foreign, &named}) {
    Broker badly(folder_, free_port(), tls_keys(*bad));
    const std::string trouble = send(badly.port(), bad->ca());
    EXPECT_NE(has_code(trouble, "timedatectl"), bad == &foreign || bad == &named) << trouble;
    reported.insert(trouble);
  }
  EXPECT_EQ(reported.size(), 5U) << "two of them are of another name";
}

TEST_F(MqttTrouble, ServersThatAreNoBrokers) {
  const std::string refused = send(free_port(), "");
  const DatedCertificate good("IP:127.0.0.1", -kDayS, kDayS);
  Broker plain(folder_, free_port());
  EXPECT_THAT(send(plain.port(), good.ca()), Names("TLS"));
  Broker closed(folder_, free_port(), "allow_anonymous false\n");
  EXPECT_THAT(send(closed.port(), "", "somebody"), Names("mqtt_user mqtt_password_file"));
  TestServer silent([&silent](TestConnection&, const std::string&) {
    silent.wait_for_end();
    return false;
  });
  const std::string mute = send(silent.port(), "");
  EXPECT_THAT(mute, Names("MQTT"));
  EXPECT_TRUE(!refused.empty() && refused != mute) << refused;
}

}  // namespace
}  // namespace bess
