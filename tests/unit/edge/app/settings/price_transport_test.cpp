// Requests allowed over plain http, and the report at the start.
#include "edge/app/settings/edge_config.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class PriceTransport : public ::testing::Test {
 protected:
  /// Loads a configuration with these lines in [price]; the first is line 4.
  bool load(const std::string& price_keys) {
    chmod(folder_.write("headers", "X-Api-Key: s3cret\n").c_str(), 0600);
    path_ = folder_.write("edge.toml", "[battery]\nmap = \"" BESS_SOURCE_DIR
                                       "/edge/device/maps/alphaess.toml\"\n[price]\n" +
                                           price_keys);
    error_.clear();
    return load_edge_config(path_, config_, error_);
  }

  const TemporaryFolder folder_;
  std::string path_;
  EdgeConfig config_;
  std::string error_;
};

TEST_F(PriceTransport, PlainHttpToAnotherMachineNeedsTheKeyAndIsSaid) {
  EXPECT_FALSE(load("url = \"http://192.168.1.9/records\"\n"));
  EXPECT_THAT(error_, Names(path_ + ":4 [price] url allow_http = true"));
  EXPECT_FALSE(load("url = \"http://localhost/records\"\n"));
  ASSERT_TRUE(load("url = \"http://192.168.1.9/records\"\nallow_http = true\n")) << error_;
  const SettingsNote note = transport_note(config_.price);
  EXPECT_TRUE(note.is_warning);
  EXPECT_THAT(note.text, Names("http"));
}

TEST_F(PriceTransport, InsideThisMachineAndOverTlsNoKeyIsNeeded) {
  ASSERT_TRUE(load("url = \"http://127.0.0.1:8080/records\"\n")) << error_;
  EXPECT_FALSE(transport_note(config_.price).is_warning);
  EXPECT_THAT(transport_note(config_.price).text, Names("http"));
  ASSERT_TRUE(load("ca_file = \"headers\"\nurl = \"https://a.example/records\"\n")) << error_;
  EXPECT_EQ(transport_note(config_.price).text, "https");
}

/// https and http may share host and port in a URL.
TEST_F(PriceTransport, TheHistorysUrlIsHeldToTheSame) {
  const std::string urls =
      "history_url = \"http://a.example:443/past\"\nca_file = \"headers\"\n"
      "url = \"https://a.example/records\"\n";
  EXPECT_FALSE(load(urls));
  EXPECT_THAT(error_, Names(path_ + ":4 [price] history_url allow_http"));
  ASSERT_TRUE(load(urls + "allow_http = true\n")) << error_;
  EXPECT_TRUE(transport_note(config_.price).is_warning);
  EXPECT_FALSE(load(urls + "allow_http = true\nheader_file = \"headers\"\n"));
  EXPECT_THAT(error_, AllOf(Names("header_file"), Not(Names("allow_http"))));
}

TEST_F(PriceTransport, SecretsNeverGoOverPlainHttp) {
  for (const char* host : {"127.0.0.1:8080", "192.168.1.9"}) {
    const std::string allowed = "allow_http = true\n";
    EXPECT_FALSE(
        load("header_file = \"headers\"\nurl = \"http://" + std::string(host) + "/\"\n" + allowed));
    EXPECT_THAT(error_, Names(path_ + ":4 [price] header_file"));
    EXPECT_FALSE(load("url = \"http://me:s3cret@" + std::string(host) + "/\"\n" + allowed));
    EXPECT_THAT(error_, AllOf(Names(path_ + ":4 [price] url"), Not(HasSubstr("header_file"))));
    EXPECT_THAT(error_, testing::Not(HasSubstr("s3cret")));
  }
  EXPECT_TRUE(
      load("ca_file = \"headers\"\nheader_file = \"headers\"\n"
           "url = \"https://me:s3cret@a.example/\"\n"))
      << error_;
}

}  // namespace
}  // namespace bess
