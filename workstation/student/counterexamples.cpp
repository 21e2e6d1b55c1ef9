#include "workstation/student/counterexamples.h"

#include <fmt/core.h>

#include "shared/host/csv.h"

namespace bess {
namespace {

constexpr std::string_view kHeader =
    "minute_of_quarter_hour,quarter_hour,context_class,soc_index,price_eur_per_mwh";

}  // namespace

std::string counterexamples_csv(const std::vector<LatticeState>& states) {
  std::string text = fmt::format("{}\n", kHeader);
  for (const LatticeState& s : states) {
    text += fmt::format("{},{},{},{},{}\n", s.minute_of_quarter_hour, s.quarter_hour,
                        s.context_class, s.soc_index, s.price_eur_per_mwh);
  }
  return text;
}

std::vector<LatticeState> parse_counterexamples_csv(std::string_view text,
                                                    const std::string& name) {
  std::vector<LatticeState> states;
  if (text == fmt::format("{}\n", kHeader)) return states;
  const CsvTable table(text, name, kHeader);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const auto whole = [&](std::size_t column) {
      return static_cast<std::int16_t>(table.number(row, column));
    };
    states.push_back({whole(0), whole(1), whole(2), whole(3), whole(4)});
  }
  return states;
}

}  // namespace bess
