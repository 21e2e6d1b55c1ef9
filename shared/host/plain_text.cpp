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

}  // namespace

std::string_view plain_text(std::string_view text, std::string_view name) {
  using namespace std::string_view_literals;
  if (text.starts_with("\x1F\x8B")) {
    fail("{}: contains gzip data (compressed twice, or sent without Content-Encoding): use gunzip",
         name);
  }
  if (text.starts_with("PK\x03\x04")) fail("{}: a ZIP archive: unzip it first", name);
  if (text.starts_with("\xFF\xFE"sv) || text.starts_with("\xFE\xFF"sv)) {
    fail("{}: UTF-16 text: save it as UTF-8", name);
  }
  if (text.find('\0') != std::string_view::npos) {
    fail("{}: contains NUL bytes, possibly UTF-16: save it as UTF-8", name);
  }
  if (text.find('\r') != std::string_view::npos && text.find('\n') == std::string_view::npos) {
    fail("{}: lines end with CR only: save it with LF or CR LF", name);
  }
  text = without_byte_order_mark(text);
  if (is_web_page(text)) {
    fail("{}: a web page, not data (maintenance or a proxy's log-in?)", name);
  }
  return text;
}

}  // namespace bess
