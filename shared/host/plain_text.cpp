#include "shared/host/plain_text.h"

#include <algorithm>
#include <cctype>

#include "shared/host/user_error.h"

namespace bess {
namespace {

bool starts_with_any_case(std::string_view text, std::string_view lower) {
  return text.size() >= lower.size() &&
         std::equal(lower.begin(), lower.end(), text.begin(), [](char wanted, char found) {
           return wanted == std::tolower(static_cast<unsigned char>(found));
         });
}

bool is_web_page(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (first == std::string_view::npos) return false;
  text.remove_prefix(first);
  return starts_with_any_case(text, "<!doctype html") || starts_with_any_case(text, "<html");
}

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

}  // namespace

std::string_view plain_text(std::string_view text, std::string_view name) {
  using namespace std::string_view_literals;
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with("PK\x03\x04")) fail("{}: a ZIP archive: unzip it first", name);
  if (text.starts_with("\xFF\xFE"sv) || text.starts_with("\xFE\xFF"sv)) {
    fail("{}: UTF-16 text: save it as UTF-8", name);
  }
  if (text.find('\0') != std::string_view::npos) {
    fail("{}: holds NUL bytes: UTF-16 text? save it as UTF-8", name);
  }
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (is_web_page(text)) {
    fail("{}: a web page, not data (maintenance or a proxy's log-in?)", name);
  }
  return text;
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
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace bess
