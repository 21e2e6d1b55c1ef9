// The tables of the backtest's page, cell by cell against the JSON of the same, and that JSON
// against its schema: every key is there, none besides, and null stands where it may alone.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <map>
#include <set>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "workstation/report/backtest_report.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/figures/page_files.h"

namespace bess {
namespace {

/// One row: its name, and its cells by the heads of their columns in their order.
struct ShownRow {
  std::string name;
  std::vector<std::pair<std::string, std::string>> cells;
};

std::string between(const std::string& text, const std::string& from, const std::string& to,
                    std::size_t& at) {
  const std::size_t begin = text.find(from, at);
  if (begin == text.npos) {
    at = text.npos;
    return {};
  }
  const std::size_t end = text.find(to, begin + from.size());
  at = end;
  return text.substr(begin + from.size(), end - begin - from.size());
}

/// The rows of the table with this caption.
std::vector<ShownRow> rows_of(const std::string& page, const std::string& caption) {
  std::size_t at = page.find("<caption>" + html_escaped(caption) + "</caption>");
  EXPECT_NE(at, page.npos) << caption;
  const std::string table = between(page, "<tbody>", "</tbody>", at);
  std::vector<ShownRow> rows;
  for (std::size_t row_at = 0; row_at != table.npos;) {
    const std::string row = between(table, "<tr>", "</tr>", row_at);
    if (row_at == table.npos) break;
    std::size_t cell_at = 0;
    ShownRow shown{between(row, "<th scope=\"row\">", "</th>", cell_at), {}};
    for (;;) {
      const std::string head = between(row, "<td data-label=\"", "\"", cell_at);
      if (cell_at == row.npos) break;
      shown.cells.emplace_back(head, between(row, ">", "</td>", cell_at));
    }
    rows.push_back(std::move(shown));
  }
  return rows;
}

/// As a page shows a figure.
std::string shown(const JsonValue& value, const char* format) {
  if (value.is_null()) return "\u2013";
  return with_true_minus(fmt::format(fmt::runtime(format), value.number().value()));
}

/// A page's column, the JSON's key, and how it is shown.
struct Column {
  const char *head, *key, *format;
};

void expect_row(const ShownRow& row, const JsonValue& told, const std::vector<Column>& columns) {
  ASSERT_EQ(row.cells.size(), columns.size());
  EXPECT_EQ(row.name, told["policy"].text_or(""));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    EXPECT_EQ(row.cells[c].first, columns[c].head);
    ASSERT_TRUE(told[columns[c].key].exists()) << columns[c].key;
    EXPECT_EQ(row.cells[c].second, shown(told[columns[c].key], columns[c].format))
        << row.name << ", " << columns[c].head;
  }
}

/// The keys of `told` are those of `kind` in the schema; what may not be null is not.
void expect_kind(const JsonValue& told, const JsonValue& kind) {
  std::set<std::string> keys, known;
  for (const JsonValue member : told) keys.emplace(member.key());
  for (const JsonValue property : kind["properties"]) {
    known.emplace(property.key());
    if (property["type"].text_or("") == std::string_view("number")) {
      EXPECT_TRUE(told[std::string(property.key()).c_str()].number()) << property.key();
    }
  }
  EXPECT_EQ(keys, known);
  for (const JsonValue required : kind["required"])
    EXPECT_TRUE(keys.contains(required.text_or("")));
}

/// Six days of three months, of which each earns `eur` and a part of it that no digit ends.
Evaluation earned(double eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 8;
  for (int day = 0; day < 6; ++day) {
    const double profit_eur = eur * (1 + 0.37 * day) / 3 - 11 * (day % 2);
    evaluation.days.push_back({fmt::format("2023-0{}-2{}", 1 + day / 2, 6 + day % 2), profit_eur,
                               1 / 3.0 + day, 4, 0.5, 2 / 3.0});
  }
  return evaluation;
}

TEST(BacktestPage, EachCellIsTheJsons) {
  BacktestResults results{{}, {90, 120, 31}, {{"2022-12", "none"}}, 120, 8, "made by hand"};
  for (const auto& [name, eur] : {std::pair{"rbc", 100.0}, {"sdp", -380.0}, {"student", 1e5}}) {
    WalkForward policy{name, earned(eur), {"2023-01", "2023-02", "2023-03"}, {}};
    for (std::size_t month = 0; month < 3; ++month) {
      Evaluation part = policy.total;
      part.days = {policy.total.days[2 * month], policy.total.days[2 * month + 1]};
      policy.by_month.push_back(std::move(part));
    }
    results.policies.push_back(std::move(policy));
  }
  const TemporaryFolder folder;
  write_backtest_page(results, folder.file(""));
  const std::string page = read_file(folder.file("backtest.html"));
  const Json json = Json::parse(backtest_json(results).line());
  const Json schema = Json::parse(page_file("answers.schema.json"));
  const JsonValue kinds = schema.value()["$defs"];
  expect_kind(json.value(), kinds["answer_backtest"]);
  const std::vector<Column> columns{
      {"EUR/day/MWh", "profit_eur_per_day_per_mwh", "{:.1f}"},
      {"s.e.", "profit_standard_error", "{:.1f}"},
      {"By month", "profit_standard_error_by_month", "{:.1f}"},
      {"Gain", "gain_eur_per_day_per_mwh", "{:+.1f}"},
      {"Its s.e.", "gain_standard_error", "{:.1f}"},
      {"Gain by month", "gain_standard_error_by_month", "{:.1f}"},
      {"At wear 10", "profit_at_wear_10_eur_per_day_per_mwh", "{:.1f}"},
      {"Cycles/day", "cycles_per_day", "{:.2f}"},
      {"Drawdown", "drawdown_eur_per_mwh", "{:.0f}"}};
  const auto rows = rows_of(page, "EUR per day per MWh of capacity, all traded days");
  ASSERT_EQ(rows.size(), 3U);
  auto row = rows.begin();
  for (const JsonValue policy : json.value()["policies"]) {
    expect_kind(policy, kinds["policy_of_backtest"]);
    expect_row(*row++, policy, columns);
  }
  const auto months = rows_of(page, "Profit by month, and the gain over rbc");
  ASSERT_EQ(months.size(), 4U);
  ASSERT_EQ(months.back().cells.size(), 3U);
  std::size_t m = 0;
  for (const JsonValue month : json.value()["months"]) {
    EXPECT_EQ(months.back().cells[m].first, month["month"].text_or(""));
    EXPECT_EQ(months.back().cells[m].second, shown(month["fitted_days"], "{:.0f}"));
    ++m;
  }
}

}  // namespace
}  // namespace bess
