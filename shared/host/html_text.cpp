#include "shared/host/html_text.h"

namespace bess {

std::string html_escaped(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += c;
    }
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

}  // namespace bess
