// TOML reader: its values, and that every mistake is one line with file and line.
#include "shared/host/toml_document.h"

#include <gmock/gmock.h>

#include <fmt/core.h>

#include <cstring>

#include "shared/host/toml_traps.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/toml_mistakes.h"

namespace bess {
namespace {

int trap_line(std::string_view toml) { return TomlTrapFinder(toml).find().line; }

TomlValue parsed(std::string_view text) {
  TomlValue document;
  std::string error;
  EXPECT_TRUE(parse_toml_text(text, "some.toml", document, error)) << error;
  return document;
}

TEST(TomlDocument, HoldsValuesAndWhereTheyWereWritten) {
  const TomlValue document = parsed(
      "on = true\n"
      "count = 9223372036854775807\n"
      "[battery]\n"
      "share = 0.5\n"
      "name = \"\u00E9\"\n"
      "since = 2023-01-01\n"
      "list = [1,\n  2.5, { a.b = 'x' }]\n");
  EXPECT_EQ(*document.find("on")->as<bool>(), true);
  EXPECT_EQ(*document.find("count")->as<std::int64_t>(), INT64_MAX);
  const TomlValue& battery = *document.find("battery");
  EXPECT_EQ(battery.line, 3);
  EXPECT_EQ(*battery.file, "some.toml");
  EXPECT_EQ(*battery.find("share")->as<double>(), 0.5);
  EXPECT_EQ(*battery.find("name")->as<std::string>(), "\u00E9");
  EXPECT_TRUE(battery.find("since")->as<std::monostate>());
  EXPECT_EQ(battery.find("since")->number(), std::nullopt);
  const auto& list = *battery.find("list")->as<TomlArray>();
  ASSERT_EQ(list.size(), 3U);
  EXPECT_EQ(list[0].number(), 1);
  EXPECT_EQ(list[1].number(), 2.5);
  EXPECT_EQ(list[1].line, 8);
  EXPECT_EQ(*list[2].find("a")->find("b")->as<std::string>(), "x");
  EXPECT_EQ(document.find("none"), nullptr);
  EXPECT_EQ(list[0].find("none"), nullptr);
}

/// toml++ compares the first character with incomplete ranges of white space.
TEST(TomlDocument, AContinuedLineMayBeginWithAnyCharacter) {
  for (const char* const letter :
       {"\u00E9", "\u0416", "\u20AC", "\u3042", "\U0001F50B", "\u00A0"}) {
    const std::string text = letter;
    const TomlValue document =
        parsed("a = \"\"\"\nx\\\n \n\t" + text + " y \\\r\n" + text +
               "\"\"\"\nb = [[1], [\n[+2]]]\n[c]\nd = '''\\\n" + text + "'''\n");
    EXPECT_EQ(*document.find("a")->as<std::string>(), "x" + text + " y " + text);
    EXPECT_EQ(*document.find("c")->find("d")->as<std::string>(), "\\\n" + text);
    EXPECT_EQ(document.find("c")->line, 8);
  }
}

TEST(TomlDocument, AByteOrderMarkIsSkipped) {
  EXPECT_EQ(parsed("\xEF\xBB\xBF[battery]\n").find("battery")->line, 1);
  EXPECT_TRUE(parsed("\xEF\xBB\xBF").as<TomlMembers>()->empty());
}

TEST(TomlDocument, EveryMistakeIsOneLineThatNamesFileAndLine) {
  for (const TomlMistake& mistake : toml_mistakes()) {
    SCOPED_TRACE(mistake.text.substr(0, 40));
    TomlValue document;
    std::string error;
    EXPECT_FALSE(parse_toml_text(mistake.text, "some.toml", document, error));
    EXPECT_THAT(error, Names(fmt::format("some.toml:{} {}", mistake.line, mistake.names)));
    EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  }
}

TEST(TomlDocument, AFileThatCannotBeReadIsNamed) {
  const TemporaryFolder folder;
  TomlValue document;
  std::string error;
  EXPECT_FALSE(parse_toml_file(folder.file("missing.toml"), document, error));
  EXPECT_THAT(error, Names("missing.toml " + std::string(std::strerror(ENOENT))));
  EXPECT_FALSE(parse_toml_file(folder.file(""), document, error));
  EXPECT_THAT(error, Names(folder.file("")));
}

/// An endless device represents a file of any size: neither memory nor time may grow with it.
TEST(TomlDocument, AFileIsReadNoFurtherThanItCouldBeParsed) {
  TomlValue document;
  std::string error;
  EXPECT_FALSE(parse_toml_file("/dev/zero", document, error));
  EXPECT_THAT(error, Names("/dev/zero:1 256 KiB"));
}

TEST(TomlTraps, NonAsciiIsFoundOutsideQuotesAndCommentsOnly) {
  EXPECT_EQ(trap_line(""), 0);
  EXPECT_EQ(trap_line("key = 1  # \u00E9\npath = \"\u00E9\"\n"), 0);
  EXPECT_EQ(trap_line("a = '\u00E9#'\nb = \"\\\"\u00E9\"\nc = 1"), 0);
  EXPECT_EQ(trap_line("a = \"\"\"\n\"\u00E9\"\n\"\"\"\nb = '''\n\u00E9'''"), 0);
  EXPECT_EQ(trap_line("a = 1\n\u00E9 = 2\n"), 2);
  EXPECT_EQ(trap_line("a = \"\"\"\n\n\"\"\"\u00E9\n"), 3);
  EXPECT_EQ(trap_line("a = \"unclosed\nb = \u00E9\n"), 2);
  EXPECT_EQ(trap_line("a = \"unclosed"), 0);
  EXPECT_EQ(trap_line("a = 1\nb = 30'''\u00E9 # found by fuzzing"), 2);
  EXPECT_EQ(trap_line("a = 5p.9.\"\"\"\"&\u00E9"), 1);
  EXPECT_EQ(trap_line("a = 5['''\u00E9\nb = 5='''\u00E9"), 1);
  EXPECT_EQ(trap_line("a = [5.'''\u00E9'''"), 1);
  EXPECT_EQ(trap_line("a = \"b,c\"='\u00E9'"), 1);
  EXPECT_EQ(trap_line("a = {b=\"\u00E9\", c=[\n\"\u00E9\", '\u00E9'\n]}"), 0);
  EXPECT_EQ(trap_line("a = '''\u00E9''''\nb = [\"\u00E9\",'\u00E9']"), 0);
}

TEST(TomlTraps, OnlyTheDotsOfOneKeyCount) {
  const std::string dots(20, '.');
  EXPECT_EQ(trap_line("a = \"" + dots + "\"  # " + dots + "\nb = '''\n" + dots + "'''"), 0);
  std::string numbers;
  for (int i = 0; i < 20; ++i) numbers += "1.5, ";
  EXPECT_EQ(trap_line("a.b = [" + numbers + "]\nc = { d.e = 1.5, f.g = 2.5 }\n"), 0);
  EXPECT_EQ(trap_line("\n[a" + dots + "]"), 2);
  EXPECT_EQ(trap_line("a = { b . c" + dots + " = 1 }"), 1);
}

}  // namespace
}  // namespace bess
