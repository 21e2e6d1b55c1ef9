#include "edge/page/html_number.h"

#include "shared/host/html_text.h"
#include "shared/host/text.h"

namespace bess {

std::string html_number(JsonValue value, std::string_view path, const NumberStyle& style) {
  const std::optional<double> number = value.number();
  if (!number) return "\u2013";
  const double shown = *number / style.divisor;
  const std::string digits = formatted(style.has_sign ? "%+.*f" : "%.*f", style.decimals, shown);
  // What rounds to nothing has no sign.
  const bool is_zero = digits.find_first_of("123456789") == digits.npos;
  const std::string plain = is_zero ? formatted("%.*f", style.decimals, 0.0) : digits;
  const std::string text =
      formatted("<data value=\"%.12g\" data-of=\"", *number) + html_escaped(path) +
      formatted("\" data-divisor=\"%g\">", style.divisor) + with_true_minus(plain) + "</data>";
  if (*style.unit == '\0') return text;
  return "<span class=\"with-unit\">" + text + "&#160;" + html_escaped(style.unit) + "</span>";
}

}  // namespace bess
