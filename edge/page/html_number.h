// A number of an answer, as the page shows it.
#pragma once

#include <string>
#include <string_view>

#include "shared/host/json.h"

namespace bess {

struct NumberStyle {
  int decimals = 0;
  double divisor = 1;  ///< from the answer's unit to the page's
  const char* unit = "";
  bool has_sign = false;  ///< + before what is above 0
};

/// `<data value="1520" data-of="status/last/soc_e4" data-divisor="100">15.2</data>` with its unit;
/// a dash where the answer has no number there. `path` leads from the answer's name to the value,
/// an index where it passes a list.
std::string html_number(JsonValue value, std::string_view path, const NumberStyle& style);

}  // namespace bess
