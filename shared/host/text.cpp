#include "shared/host/text.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>
#include <numeric>

namespace bess {

namespace {

constexpr std::size_t kLettersMax = 40;  // no suggestions for longer words

/// Restricted Damerau-Levenshtein distance.
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_swap) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

/// The C0 characters and DEL, and in UTF-8 the C1 ones: a terminal reads U+009B as ESC [.
bool is_control(std::string_view text, std::size_t at) {
  const auto c = static_cast<unsigned char>(text[at]);
  const auto next = static_cast<unsigned char>(at + 1 < text.size() ? text[at + 1] : 0);
  return c < 0x20 || c == 0x7F || (c == 0xC2 && next >= 0x80 && next < 0xA0);
}

/// Never cuts a multi-byte character.
std::string_view cut(std::string_view text, std::size_t size_max) {
  if (text.size() <= size_max) return text;
  const auto continues = [&text](std::size_t at) {
    return (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80;
  };
  while (size_max > 0 && continues(size_max)) --size_max;
  return text.substr(0, size_max);
}

void add_formatted_list(std::string& text, const char* format, std::va_list arguments) {
  std::va_list again;
  va_copy(again, arguments);
  const int size = std::vsnprintf(nullptr, 0, format, arguments);
  if (size > 0) {
    const std::size_t before = text.size();
    text.resize(before + static_cast<std::size_t>(size));
    std::vsnprintf(text.data() + before, static_cast<std::size_t>(size) + 1, format, again);
  }
  va_end(again);
}

}  // namespace

std::string nearest_word(std::string_view given, const std::vector<std::string>& known) {
  if (given.size() < 2 || given.size() > kLettersMax) return {};
  std::string best;
  std::size_t best_distance = given.size() / 3 + 1;
  for (const std::string& word : known) {
    const std::size_t far = word.starts_with(given) ? 0 : distance(given, word);
    if (far >= best_distance) continue;
    best = word;
    best_distance = far;
  }
  return best;
}

std::string did_you_mean(std::string_view given, const std::vector<std::string>& known) {
  const std::string word = nearest_word(given, known);
  return word.empty() ? word : "; did you mean " + word + "?";
}

bool equals_ignoring_case(std::string_view a, std::string_view b) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
  return std::ranges::equal(a, b, {}, lower, lower);
}

std::string html_escaped(std::string_view text) {
  struct Entity {
    char character;
    std::string_view text;
  };
  constexpr Entity kEntities[] = {
      {'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}};
  std::string out;
  for (const char c : text) {
    const auto* const entity = std::ranges::find(kEntities, c, &Entity::character);
    out += entity == std::end(kEntities) ? std::string_view(&c, 1) : entity->text;
  }
  return out;
}

std::string with_true_minus(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789";
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool begins = i == 0 || text[i - 1] == ' ' || text[i - 1] == '(';
    const bool is_minus = text[i] == '-' && begins && i + 1 < text.size() &&
                          kDigits.find(text[i + 1]) != kDigits.npos;
    out += is_minus ? std::string("\u2212") : std::string(1, text[i]);
  }
  return out;
}

bool holds_control(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (is_control(text, i)) return true;
  }
  return false;
}

std::string formatted(const char* format, ...) {
  std::string text;
  std::va_list arguments;
  va_start(arguments, format);
  add_formatted_list(text, format, arguments);
  va_end(arguments);
  return text;
}

void add_formatted(std::string& text, const char* format, ...) {
  std::va_list arguments;
  va_start(arguments, format);
  add_formatted_list(text, format, arguments);
  va_end(arguments);
}

void replace_all(std::string& text, std::string_view what, std::string_view by) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + by.size())) {
    text.replace(at, what.size(), by);
  }
}

std::string comment_lines(std::string_view text) {
  std::string lines;
  while (!text.empty()) lines.append("# ").append(take_line(text)).append("\n");
  return lines;
}

std::string one_line(std::string_view text, std::size_t size_max) {
  std::string line;
  for (std::size_t i = 0; i < text.size() && line.size() <= size_max; ++i) {
    const bool control = is_control(text, i);
    if (control && static_cast<unsigned char>(text[i]) == 0xC2) ++i;  // two bytes long
    if (!control && text[i] != ' ') {
      line += text[i];
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  line.resize(cut(line, size_max).size());
  while (line.ends_with(' ')) line.pop_back();
  return line;
}

std::string counted(std::size_t count, std::string_view noun) {
  return std::to_string(count).append(" ").append(noun).append(count == 1 ? "" : "s");
}

}  // namespace bess
