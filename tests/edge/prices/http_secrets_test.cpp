// Secrets of the price request: what the header file may hold, and what a log may show.
#include "edge/prices/http_trust.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

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
      // Whatever is not known to be harmless may be a secret.
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

struct HeaderFile {
  const char* text;
  mode_t mode;
  const char* codes;
};

TEST(HeaderFile, KeepsHeadersAndSkipsComments) {
  const TemporaryFolder folder;
  const std::string path = folder.write(
      "headers", "# from the portal\n\nX-Api-Key: abc def\r\n   Authorization: Bearer x\n");
  ASSERT_EQ(chmod(path.c_str(), 0640), 0);
  FixedText<2047> headers;
  std::string error;
  ASSERT_TRUE(load_http_headers(path.c_str(), headers, error)) << error;
  EXPECT_EQ(headers, "X-Api-Key: abc def\nAuthorization: Bearer x");
}

TEST(HeaderFile, AFolderIsNoFile) {
  const TemporaryFolder folder;
  FixedText<2047> headers;
  std::string error;
  EXPECT_FALSE(load_http_headers(folder.file(".").c_str(), headers, error));
  EXPECT_THAT(error, HasSubstr(folder.file(".")));
}

TEST(HeaderFile, TheLastLineNeedsNoEnd) {
  const TemporaryFolder folder;
  const std::string path = folder.write("headers", "A: b\nC: d");
  ASSERT_EQ(chmod(path.c_str(), 0600), 0);
  FixedText<2047> headers;
  std::string error;
  ASSERT_TRUE(load_http_headers(path.c_str(), headers, error)) << error;
  EXPECT_EQ(headers, "A: b\nC: d");
}

TEST(HeaderFile, ANameIsOfLettersDigitsDashAndUnderscore) {
  const TemporaryFolder folder;
  const auto is_taken = [&](const std::string& name) {
    const std::string path = folder.write("headers", name + ": v\n");
    EXPECT_EQ(chmod(path.c_str(), 0600), 0);
    FixedText<2047> headers;
    std::string error;
    return load_http_headers(path.c_str(), headers, error);
  };
  for (const char* const name : {"azAZ", "X-0", "X_9", "0", "9"})
    EXPECT_TRUE(is_taken(name)) << name;
  // The neighbours of each range in ASCII.
  for (const char* const name : {"X/", "X@", "X[", "X`", "X{", "X;", "X=", "X.", "X,", "X\xc3"}) {
    EXPECT_FALSE(is_taken(name)) << name;
  }
}

TEST(HeaderFile, MistakesAreOneLineWithoutTheContent) {
  const TemporaryFolder folder;
  const std::string long_text = "X: " + std::string(3'000, 's') + "\n";
  const HeaderFile table[] = {
      {"X-Api-Key: s3cret\n", 0644, "chmod o-rwx"}, {"s3cret\n", 0600, "headers:1"},
      {"A: b\n: s3cret\n", 0600, "headers:2"},      {"A b: s3cret\n", 0600, "headers:1"},
      {"A: s3cret\x01\n", 0600, "headers:1"},       {long_text.c_str(), 0600, "headers"},
  };
  for (const HeaderFile& row : table) {
    const std::string path = folder.write("headers", row.text);
    ASSERT_EQ(chmod(path.c_str(), row.mode), 0);
    FixedText<2047> headers;
    std::string error;
    EXPECT_FALSE(load_http_headers(path.c_str(), headers, error));
    EXPECT_THAT(error, AllOf(HasSubstr(path), Names(row.codes)));
    EXPECT_THAT(error, Not(HasSubstr("s3cret")));
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  FixedText<2047> headers;
  std::string error;
  EXPECT_FALSE(load_http_headers(folder.file("none").c_str(), headers, error));
  EXPECT_THAT(error, Names(folder.file("none")));
  EXPECT_FALSE(load_http_headers("/proc", headers, error));
}

}  // namespace
}  // namespace bess
