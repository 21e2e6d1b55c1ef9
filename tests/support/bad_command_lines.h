// Command lines that a program refuses, each with its exit code and the codes that its one-line
// error names (tokens.h).
#pragma once

#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "shared/host/child_process.h"
#include "tests/support/program_output.h"
#include "tests/support/tokens.h"

namespace bess {

struct BadCommandLine {
  const char* words;  ///< after the program's name, split at spaces; '' is an empty word
  int exit_code;
  const char* complaint;  ///< as of Names
};

/// The words, with file placeholders replaced by paths.
inline std::vector<std::string> words_of(const BadCommandLine& line,
                                         const std::map<std::string, std::string>& files) {
  std::vector<std::string> words;
  std::istringstream stream(line.words);
  for (std::string word; stream >> word;) {
    for (const auto& [name, path] : files) {
      if (word.starts_with(name)) word.replace(0, name.size(), path);
    }
    words.push_back(word == "''" ? "" : word);
  }
  return words;
}

/// Unreadable bounds: what a range of any double would print.
inline bool has_many_digits(const std::string& text) {
  int digits = 0;
  return std::ranges::any_of(text, [&digits](unsigned char c) {
    digits = std::isdigit(c) != 0 ? digits + 1 : 0;
    return digits > 24;
  });
}

/// A bare command prints its help before that line; any other prints only that line.
inline void expect_refused(const std::string& program, const BadCommandLine& line,
                           const std::map<std::string, std::string>& files) {
  SCOPED_TRACE(line.words);
  std::vector<std::string> arguments = words_of(line, files);
  arguments.insert(arguments.begin(), program);
  const auto [exit_code, text] = answer_of(std::move(arguments));
  EXPECT_EQ(exit_code, line.exit_code) << text;
  EXPECT_THAT(text, Names(line.complaint));
  const std::size_t last = text.rfind('\n', text.size() - 2);
  const std::string complaint = last == text.npos ? text : text.substr(last + 1);
  EXPECT_THAT(complaint, testing::StartsWith(program.substr(program.rfind('/') + 1) + ": "));
  EXPECT_TRUE(last == text.npos || text.find("Usage: ") != text.npos) << text;
  EXPECT_FALSE(has_many_digits(text)) << text;
  EXPECT_TRUE(std::ranges::none_of(text, [](char c) { return c == '\x1b' || c == '\r'; })) << text;
}

}  // namespace bess
