#include "shared/host/text.h"

#include <cstdarg>
#include <cstdio>

namespace bess {
namespace {

/// The C0 characters and DEL, and in UTF-8 the C1 ones: a terminal takes U+009B for ESC [.
bool is_control(std::string_view text, std::size_t at) {
  const auto c = static_cast<unsigned char>(text[at]);
  const auto next = static_cast<unsigned char>(at + 1 < text.size() ? text[at + 1] : 0);
  return c < 0x20 || c == 0x7F || (c == 0xC2 && next >= 0x80 && next < 0xA0);
}

/// Never inside a character of several bytes.
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
