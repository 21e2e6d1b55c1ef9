#include "workstation/cli/run_seeds.h"

#include <fmt/core.h>

#include <cmath>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "workstation/base/answer.h"
#include "workstation/report/html.h"
#include "workstation/report/rule_prices.h"

namespace bess {
namespace {

std::string number(double value) { return std::isnan(value) ? "-" : fmt::format("{:.1f}", value); }

std::string bands_csv(const std::vector<Band>& bands, std::size_t runs) {
  // soc to mean_at_wear_10 are names of before schema version 1, until the next release.
  std::string text =
      "policy,soc,runs,mean,deviation,lowest,highest,mean_at_wear_10,carry_soc,"
      "profit_eur_per_day_per_mwh_mean,profit_eur_per_day_per_mwh_deviation,"
      "profit_eur_per_day_per_mwh_min,profit_eur_per_day_per_mwh_max,"
      "profit_at_wear_10_eur_per_day_per_mwh_mean\n";
  for (const Band& b : bands) {
    const std::string figures =
        fmt::format("{:.4f},{},{:.4f},{:.4f},{:.4f}", b.mean,
                    std::isnan(b.deviation) ? "" : fmt::format("{:.4f}", b.deviation), b.low,
                    b.high, b.mean_at_reference_wear);
    text += fmt::format("{},{},{},{},{},{}\n", csv_field(b.policy), b.soc, runs, figures,
                        truth(b.soc == "carried"), figures);
  }
  return text;
}

Json band_json(const Band& b) {
  const std::string wear_mean = std::string(kReferenceWearKey) + "_mean";
  return Json::object({{"policy", b.policy},
                       {key::kCarrySoc, b.soc == "carried"},
                       {"profit_eur_per_day_per_mwh_mean", Decimals{b.mean, 4}},
                       {"profit_eur_per_day_per_mwh_deviation", Decimals{b.deviation, 4}},
                       {"profit_eur_per_day_per_mwh_min", Decimals{b.low, 4}},
                       {"profit_eur_per_day_per_mwh_max", Decimals{b.high, 4}},
                       {wear_mean.c_str(), Decimals{b.mean_at_reference_wear, 4}},
                       // Names of before schema version 1, until the next release.
                       {"soc", b.soc},
                       {"mean_eur_per_day_per_mwh", Decimals{b.mean, 4}},
                       {"deviation", Decimals{b.deviation, 4}},
                       {"lowest", Decimals{b.low, 4}},
                       {"highest", Decimals{b.high, 4}},
                       {kReferenceWearKey, Decimals{b.mean_at_reference_wear, 4}}});
}

std::string bands_html(const std::vector<Band>& bands, std::string_view soc,
                       const std::string& caption) {
  HtmlTable table{caption, {"Policy", "Mean", "s.d.", "Lowest", "Highest", "Mean at wear 10"}, {}};
  for (const Band& b : bands) {
    if (b.soc != soc || is_under_rules(b.policy)) continue;
    table.rows.push_back({b.policy, number(b.mean), number(b.deviation), number(b.low),
                          number(b.high), number(b.mean_at_reference_wear)});
  }
  return format_table(table);
}

std::string runs_html(const std::vector<RunSummary>& runs) {
  HtmlTable table{"The runs", {"Run", "Seed", "Weights", "Violations without correction"}, {}};
  for (const RunSummary& run : runs) {
    table.rows.push_back({run.folder.path.filename().string(), run.record.value("seed"),
                          run.record.figures->weights_hash,
                          fmt::format("{}", run.record.figures->violations_plain)});
  }
  return format_table(table);
}

}  // namespace

std::filesystem::path seed_folder(const std::filesystem::path& folder, std::uint64_t seed) {
  return folder / fmt::format("seed-{}", seed);
}

std::string format_bands(const std::vector<Band>& bands, std::size_t runs) {
  std::string text;
  std::string soc;
  for (const Band& b : bands) {
    if (is_under_rules(b.policy)) continue;
    if (b.soc != soc) {
      soc = b.soc;
      text += fmt::format(
          "{}{}, {} runs; EUR per day per MWh of capacity\n{:<18} {:>8} {:>8} {:>8} {:>8} {:>11}\n",
          text.empty() ? "" : "\n",
          soc == "reset" ? "Each day starts at the same SoC" : "SoC carried over from day to day",
          runs, "policy", "mean", "s.d.", "lowest", "highest", wear_column());
    }
    text += fmt::format("{:<18} {:>8} {:>8} {:>8} {:>8} {:>11}\n", b.policy, number(b.mean),
                        number(b.deviation), number(b.low), number(b.high),
                        number(b.mean_at_reference_wear));
  }
  return text;
}

std::string bands_json(const std::vector<Band>& bands, std::size_t runs) {
  Json list = Json::list();
  for (const Band& b : bands) {
    list.add(band_json(b));
  }
  Json json = answer("run_bands");
  json.set("runs", runs);
  json.set("bands", std::move(list));
  return json.line();
}

void write_seeds_report(const std::filesystem::path& folder, const std::vector<RunSummary>& runs) {
  const std::vector<Band> bands = bands_of(runs);
  write_file(folder / "seeds.csv", bands_csv(bands, runs.size()));
  const std::string title = fmt::format("The same run from {} seeds", runs.size());
  write_file(folder / "seeds.html",
             format_page(
                 title, fmt::format(
                            "<h1>{}</h1>\n<section class=\"block\">{}{}{}<p "
                            "class=\"note\">Money in EUR per day per MWh of "
                            "capacity, on the test days.</p></section>\n",
                            title, bands_html(bands, "reset", "Each day starts at the same charge"),
                            bands_html(bands, "carried", "Charge carried over from day to day"),
                            runs_html(runs))));
}

}  // namespace bess
