#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/correction/student/prove.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/report_tables.h"
#include "workstation/runs/run/run_report.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

Cell run_cell(const RunSummary& run, const fs::path& page) {
  const std::string name = run.folder.path.string();
  const fs::path report = run.folder.file(run_file::kReport);
  if (!fs::exists(report)) return text_cell(name);
  const fs::path from = fs::absolute(page).parent_path();
  const fs::path link = fs::absolute(report).lexically_relative(from);
  return {fmt::format("<a href=\"{}\">{}</a>", html_escaped(link.string()), html_escaped(name)),
          name};
}

/// Remaining violations after the last round of a failed proof.
std::string left_text(const RunSummary& run) {
  const std::string rounds = run.folder.file(run_file::kProofRounds).string();
  if (!fs::exists(rounds)) return {};
  const auto parsed = parse_proof_rounds_csv(read_file(rounds), rounds);
  return parsed.empty() ? std::string() : ": " + parsed.back().text();
}

Cell proof_cell(const RunSummary& run) {
  if (run.record.has_failed()) return text_cell("not proved" + left_text(run));
  if (!run.record.figures) return no_text_cell();
  const RunFigures& figures = *run.record.figures;
  if (figures.violations_corrected != 0) {
    return text_cell(fmt::format("{} violations", grouped(figures.violations_corrected)));
  }
  return text_cell(fmt::format("proved in {} states", grouped(figures.states_checked)));
}

std::string state_text(const RunSummary& run) {
  return run.trouble.empty() ? run.record.state() : run.trouble;
}

const Evaluation* exported_days(const RunSummary& run, EvaluationField field) {
  const NamedEvaluation* found = find_evaluation(run.evaluations, kCorrectedName);
  return found == nullptr ? nullptr : &(found->*field);
}

/// Gain over the first finished run with the same days.
Cell gain_cell(const Evaluation& days, const Evaluation& first) {
  const auto gain = &days == &first ? std::nullopt : gain_over_run(days, first);
  if (!gain) return {kNoValue};
  return number_cell(
      fmt::format("{:+.1f} \u00b1 {} ({})", gain->mean, error_text(gain->errors.plain, 1, kNoValue),
                  error_text(gain->errors.by_month, 1, kNoValue)),
      gain->mean);
}

std::vector<Cell> figure_cells(const RunSummary& run, const Evaluation* first) {
  const Evaluation* carried = exported_days(run, &NamedEvaluation::carried_over);
  if (carried == nullptr || carried->days.empty()) return std::vector<Cell>(7, Cell{kNoValue});
  const auto rows = comparison_rows(run.evaluations, &NamedEvaluation::carried_over);
  const auto row = std::ranges::find(rows, kCorrectedName, &ComparisonRow::name);
  const double reset =
      exported_days(run, &NamedEvaluation::day_reset)->profit_eur_per_day_per_mwh();
  return {number_cell(static_cast<double>(row->days), 0),
          number_cell(fmt::format("{:.1f} \u00b1 {} ({})", row->profit,
                                  error_text(row->errors.plain, 1, kNoValue),
                                  error_text(row->errors.by_month, 1, kNoValue)),
                      row->profit),
          gain_cell(*carried, *first),
          number_cell(row->profit * carried->capacity_mwh, 1),
          number_cell(row->profit_at_reference_wear, 1),
          number_cell(100 * row->foresight_share.value_or(std::nan("")), 1),
          number_cell(reset, 1)};
}

SortTable run_table(const std::vector<RunSummary>& runs, const fs::path& page) {
  SortTable table{"runs",
                  fmt::format("Profit of the {} of each run on its test days", kCorrectedName),
                  {"Run", "State", "Proof", "Rules", "Seed", "Days", "Carried over, EUR/day/MWh",
                   "Gain, EUR/day/MWh", "EUR of this battery per day", "At wear 10, EUR/day/MWh",
                   "% of foresight", "Same charge each day, EUR/day/MWh", "Weights"},
                  {}};
  const Evaluation* first = nullptr;
  for (const RunSummary& run : runs) {
    if (first == nullptr) first = exported_days(run, &NamedEvaluation::carried_over);
  }
  for (const RunSummary& run : runs) {
    const std::string seed = run.record.value("seed");
    const std::string rules = value_text(run.record, kRulesKey);
    std::vector<Cell> row{run_cell(run, page),
                          text_cell(state_text(run)),
                          proof_cell(run),
                          text_cell(rules),
                          {html_escaped(seed), seed}};
    std::ranges::move(figure_cells(run, first), std::back_inserter(row));
    row.push_back(run.record.figures ? text_cell(run.record.figures->weights_hash)
                                     : no_text_cell());
    table.rows.push_back(std::move(row));
  }
  return table;
}

/// One column for each key with different values.
SortTable settings_table(const std::vector<RunSummary>& runs) {
  SortTable table{"settings", "Different settings", {"Run"}, {}};
  const std::vector<std::string> keys = differing_keys(runs);
  table.header.insert(table.header.end(), keys.begin(), keys.end());
  for (const RunSummary& run : runs) {
    std::vector<Cell> row{text_cell(run.folder.path.string())};
    for (const std::string& key : keys) row.push_back(text_cell(value_text(run.record, key)));
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace

RunSummary load_any_run(const RunFolder& folder) {
  RunSummary run{folder, existing_run_record(folder), {}};
  if (!run.record.figures) return run;
  try {
    return load_run_summary(folder);
  } catch (const UserError& error) {
    run.trouble = one_line(error.what());
  }
  return run;
}

std::string runs_page(const std::vector<RunSummary>& runs, const fs::path& page) {
  const std::string title = counted(runs.size(), "run");
  const SortTable settings = settings_table(runs);
  const std::string differ = settings.header.size() > 1
                                 ? sort_table_html(settings)
                                 : "<p class=\"note\">All settings are equal.</p>\n";
  return format_page(
      title,
      fmt::format(
          "<h1>{}</h1>\n{}<p class=\"note\">EUR/day/MWh: EUR per day per MWh of capacity, \u00b1 "
          "standard error (in brackets: by month). Carried over: the SoC is carried from day to "
          "day. Gain: mean day-by-day difference to the first finished run "
          "with the same days. Click a column head to sort, again to reverse; unknown values come "
          "last.</p>\n{}<script>\n{}</script>\n",
          title, sort_table_html(run_table(runs, page)), differ, page_file("sort.js")));
}

}  // namespace bess
