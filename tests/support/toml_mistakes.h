// TOML mistakes of users and from fuzzing. Unpatched toml++ crashes on many.
#pragma once

#include <string>
#include <vector>

namespace bess {

struct TomlMistake {
  std::string text;
  int line;                ///< named in the error
  const char* names = "";  ///< also named, where the text is ours and not the parser's
};

inline std::vector<TomlMistake> toml_mistakes() {
  std::string long_key = "a";
  for (int i = 0; i < 20'000; ++i) long_key += ".a";
  std::string many_tables;  // fourteen nested, and few lines
  for (int i = 0; i < 1'000; ++i)
    many_tables += "a" + std::to_string(i) + ".b.b.b.b.b.b.b.b.b.b.b.b.b = 1\n";
  std::string many_values = "a = [0";
  for (int i = 0; i < 20'000; ++i) many_values += ", 0";
  return {{"[=]", 1},
          {"a = 1\n[=]\n", 2},
          {"[[=]]\n", 1},
          {"[\n", 1},
          {"a = [1]\n \t[ +]\n", 2},
          {"a = [\n[+1], [],\n]\n[[ #]]\n", 4},
          {"[ [a]]\n", 1},
          {"[", 1},
          {"a = [[\n[=]]]\n", 2},
          {"a = [1,}", 1},
          {"a = { b = ]\n", 1},
          {"a = \"\u00E9", 1},
          {"a = '\u00E9", 1},
          {"a = \"\u00E9\n[b]\n", 1},
          {"a = \"\"\"\u00E9", 1},
          {"a = \"\"\"x\\\u00E9", 1},
          {"a = \"\\\u00E9\"", 1},
          {"a = \"\"\"x\\ \u00E9\"\"\"", 1},
          {"a = \"\"\"x\\\n\u00E9\u2028", 2},
          {"a = '''x\n\u00E9", 2},
          {"a = [\"\u00E9\", '\u00E9", 1},
          {"a = 1\n\u00E9 = 2\n", 2, "ASCII"},
          {"a = 1\u00E9\n", 1, "ASCII"},
          {"\xEF\xBB\xBF\xEF\xBB\xBF"
           "a = 1\n",
           1, "ASCII"},  // one byte order mark, not two
          {"\xFF\xFE", 1, "ASCII"},
          {long_key + " = 1\n", 1},
          {"[" + long_key + "]\n", 1},
          {"a = " + std::string(9'000, '['), 1},
          {"a = " + std::string(100'000, '['), 1},
          {many_values + "]\n", 1},
          {many_tables, 667},
          {"b = 1\n" + std::string(20'000, '\n'), 10'001},
          {std::string(300 * 1024, '#'), 1, "256 KiB"},
          {"a = 1\na = 2\n", 2},
          {"[a]\rb = 1\r", 1, "CR LF"},
          {"a = 1\r\nb = 2\r", 2, "CR LF"},
          {"a = \n", 1}};
}

}  // namespace bess
