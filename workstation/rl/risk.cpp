#include "workstation/rl/risk.h"

#include <algorithm>
#include <charconv>

#include "shared/host/user_error.h"

namespace bess {

Risk parse_risk(std::string_view text) {
  if (text == "mean") return {};
  constexpr std::string_view kCvar = "cvar:";
  Risk risk;
  if (text.starts_with(kCvar)) {
    const char* const end = text.data() + text.size();
    const auto read = std::from_chars(text.data() + kCvar.size(), end, risk.worst_share);
    const bool in_range = risk.worst_share > 0 && risk.worst_share <= 1;
    if (read.ec == std::errc() && read.ptr == end && in_range) return risk;
  }
  fail("--risk \"{}\": use mean, or cvar:ALPHA with a share above 0 up to 1: cvar:0.1", text);
}

double conditional_value_at_risk(const Support& support, const float* probability, double alpha) {
  double lacking = alpha;
  double sum = 0;
  for (int i = 0; i < support.count && lacking > 0; ++i) {
    const double taken = std::min(double{probability[i]}, lacking);
    sum += taken * double{support.atom(i)};
    lacking -= taken;
  }
  // Probabilities sum to 1 but for rounding: what still lacks lies on the last atom.
  return (sum + std::max(lacking, 0.0) * double{support.v_max}) / alpha;
}

}  // namespace bess
