// TOML that is not, as users write it and fuzzing found it. toml++ 3.3 as it comes crashes on most
// of it.
#pragma once

#include <string>
#include <vector>

namespace bess {

struct TomlMistake {
  std::string text;
  int line;               ///< that the complaint names
  const char* complaint;  ///< a part of it
};

inline std::vector<TomlMistake> toml_mistakes() {
  std::string long_key = "a";
  for (int i = 0; i < 20'000; ++i) long_key += ".a";
  std::string many_tables;  // fourteen in one another, and few lines
  for (int i = 0; i < 1'000; ++i)
    many_tables += "a" + std::to_string(i) + ".b.b.b.b.b.b.b.b.b.b.b.b.b = 1\n";
  std::string many_values = "a = [0";
  for (int i = 0; i < 20'000; ++i) many_values += ", 0";
  return {{"[=]", 1, "expected bare key"},
          {"a = 1\n[=]\n", 2, "expected bare key"},
          {"[[=]]\n", 1, "expected bare key"},
          {"a = \"\u00E9", 1, "end-of-file"},
          {"a = '\u00E9", 1, "end-of-file"},
          {"a = \"\u00E9\n[b]\n", 1, "control characters"},
          {"a = \"\"\"\u00E9", 1, "end-of-file"},
          {"a = \"\"\"x\\\u00E9", 1, "not valid TOML"},
          {"a = \"\"\"x\\\n\u00E9\u2028", 2, "end-of-file"},
          {"a = '''x\n\u00E9", 2, "end-of-file"},
          {"a = [\"\u00E9\", '\u00E9", 1, "end-of-file"},
          {"a = 1\n\u00E9 = 2\n", 2, "other than ASCII"},
          {"a = 1\u00E9\n", 1, "other than ASCII"},
          {"\xEF\xBB\xBF\xEF\xBB\xBF"
           "a = 1\n",
           1, "other than ASCII"},  // one byte order mark, not two
          {"\xFF\xFE", 1, "other than ASCII"},
          {long_key + " = 1\n", 1, "a key of more parts"},
          {"[" + long_key + "]\n", 1, "a key of more parts"},
          {"a = " + std::string(9'000, '['), 1, "nested"},
          {"a = " + std::string(100'000, '['), 1, "more lines and values"},
          {many_values + "]\n", 1, "more lines and values"},
          {many_tables, 667, "more lines and values"},
          {"b = 1\n" + std::string(20'000, '\n'), 10'001, "more lines and values"},
          {std::string(300 * 1024, '#'), 1, "longer than 256 KiB"},
          {"a = 1\na = 2\n", 2, "cannot redefine"},
          {"[a]\rb = 1\r", 1, "ends in CR alone: save it with LF"},
          {"a = 1\r\nb = 2\r", 2, "ends in CR alone"},
          {"a = \n", 1, "not valid TOML"}};
}

}  // namespace bess
