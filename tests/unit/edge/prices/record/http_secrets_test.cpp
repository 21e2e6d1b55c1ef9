// Secrets of the price request: allowed contents of the header file and of a log.
#include "edge/prices/record/transport_security.h"

#include <gmock/gmock.h>
#include <sys/stat.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

TEST(LoggableUrl, HidesUsersAndSecretQueryValues) {
  const struct {
    const char* url;
    const char* shown;
  } table[] = {
      {"https://a.example/records?limit=20&order_by=datetime%20desc",
       "https://a.example/records?limit=20&order_by=datetime%20desc"},
      {"https://user:pass@a.example:8443/x", "https://a.example:8443/x"},
      {"https://user@a.example", "https://a.example"},
      {"https://a.example/x?key=1&limit=2", "https://a.example/x?key=...&limit=2"},
      {"https://a.example/x?limit=2&apikey=1", "https://a.example/x?limit=2&apikey=..."},
      {"https://a.example/x?API_KEY=1", "https://a.example/x?API_KEY=..."},
      {"https://a.example/x?securityToken=a-b&d=A85",
       "https://a.example/x?securityToken=...&d=..."},
      {"https://a.example/x?rows=1;token=2", "https://a.example/x?rows=1;token=..."},
      {"https://a.example/x?token=a=b", "https://a.example/x?token=..."},
      {"https://a.example/u@v?where=a@b", "https://a.example/u@v?where=a@b"},
      // Anything not known to be harmless may be a secret.
      {"https://a.example/x?code=1&appid=2&sig=3&pwd=4&limit=5",
       "https://a.example/x?code=...&appid=...&sig=...&pwd=...&limit=5"},
      {"https://a.example/x?Limit=1&xlimit=2&limitx=3",
       "https://a.example/x?Limit=...&xlimit=...&limitx=..."},
      {"https://a.example/x?0123abcd", "https://a.example/x?..."},
      {"https://a.example/x?c2VjcmV0==", "https://a.example/x?..."},
      {"https://a.example/x?limit=1?code=2", "https://a.example/x?limit=1?code=..."},
      {"https://a.example/x#access_token=1", "https://a.example/x#access_token=..."},
      {"https://a.example/x;jsessionid=1?limit=2", "https://a.example/x;jsessionid=...?limit=2"},
      {"https://a.example/x?&&limit=1&", "https://a.example/x?&&limit=1&"},
      {"https://a.example?code=1", "https://a.example?code=..."},
      {"https://p@ss:w@a.example/", "https://a.example/"},
      {"", ""},
  };
  for (const auto& row : table) EXPECT_EQ(loggable_url(row.url).view(), row.shown) << row.url;
}

class HeaderFile : public ::testing::Test {
 protected:
  bool load(const std::string& text, mode_t mode = 0600) {
    const std::string path = folder_.write("headers", text);
    EXPECT_EQ(chmod(path.c_str(), mode), 0);
    return load_from(path);
  }
  bool load_from(const std::string& path) {
    error_.clear();
    return load_http_headers(path.c_str(), headers_, error_);
  }

  const TemporaryFolder folder_;
  FixedText<2047> headers_;
  std::string error_;
};

TEST_F(HeaderFile, KeepsHeadersAndSkipsComments) {
  ASSERT_TRUE(load("# from the portal\n\nX-Api-Key: abc def\r\n   Authorization: Bearer x\n", 0640))
      << error_;
  EXPECT_EQ(headers_, "X-Api-Key: abc def\nAuthorization: Bearer x");
  ASSERT_TRUE(load("A: b\nC: d")) << error_;
  EXPECT_EQ(headers_, "A: b\nC: d");
}

TEST_F(HeaderFile, ANameIsOfLettersDigitsDashAndUnderscore) {
  for (const std::string name : {"azAZ", "X-0", "X_9", "0", "9"}) {
    EXPECT_TRUE(load(name + ": v\n")) << name;
  }
  // The neighbours of each range in ASCII.
  for (const std::string name : {"X/", "X@", "X[", "X`", "X{", "X;", "X=", "X.", "X,", "X\xc3"}) {
    EXPECT_FALSE(load(name + ": v\n")) << name;
  }
}

TEST_F(HeaderFile, MistakesAreOneLineWithoutTheContent) {
  const struct {
    std::string text;
    mode_t mode;
    const char* codes;
  } table[] = {
      {"X-Api-Key: s3cret\n", 0644, "chmod o-rwx"},
      {"s3cret\n", 0600, "headers:1"},
      {"A: b\n: s3cret\n", 0600, "headers:2"},
      {"A b: s3cret\n", 0600, "headers:1"},
      {"A: s3cret\x01\n", 0600, "headers:1"},
      {"X: " + std::string(3'000, 's') + "\n", 0600, "headers"},
  };
  for (const auto& row : table) {
    EXPECT_FALSE(load(row.text, row.mode));
    EXPECT_THAT(error_, ::testing::AllOf(HasSubstr(folder_.file("headers")), Names(row.codes)));
    EXPECT_THAT(error_, ::testing::Not(HasSubstr("s3cret")));
    EXPECT_EQ(error_.find('\n'), std::string::npos);
  }
  for (const std::string& path : {folder_.file("none"), folder_.file(".")}) {
    EXPECT_FALSE(load_from(path));
    EXPECT_THAT(error_, HasSubstr(path));
  }
}

}  // namespace
}  // namespace bess
