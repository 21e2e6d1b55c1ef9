#include "workstation/run/run_seeds.h"

#include <fmt/core.h>

#include <limits>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "workstation/base/answer.h"
#include "workstation/report/rule_prices.h"

namespace bess {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr PairedDifference kNoGain{kUnknown, kUnknown};

std::string number(double value) { return error_text(value, 1); }

std::string bands_csv(const std::vector<Band>& bands, std::size_t runs) {
  std::string text =
      "policy,runs,carry_soc,"
      "profit_eur_per_day_per_mwh_mean,profit_eur_per_day_per_mwh_deviation,"
      "profit_eur_per_day_per_mwh_min,profit_eur_per_day_per_mwh_max,"
      "profit_at_wear_10_eur_per_day_per_mwh_mean,profit_standard_error,"
      "profit_standard_error_by_month,months,gain_over,gain_eur_per_day_per_mwh,"
      "gain_standard_error,gain_standard_error_by_month\n";
  for (const Band& b : bands) {
    const PairedDifference gain = b.gain.value_or(kNoGain);
    text += fmt::format("{},{},{},{:.4f},{},{:.4f},{:.4f},{:.4f},{},{},{},{},{},{},{}\n",
                        csv_field(b.policy), runs, truth(b.soc == "carried"), b.mean,
                        error_text(b.deviation, 4, ""), b.low, b.high, b.mean_at_reference_wear,
                        error_text(b.errors.plain, 4, ""), error_text(b.errors.by_month, 4, ""),
                        b.errors.months, b.gain ? csv_field(bands.front().policy) : "",
                        error_text(gain.mean, 4, ""), error_text(gain.standard_error, 4, ""),
                        error_text(gain.standard_error_by_month, 4, ""));
  }
  return text;
}

Json band_json(const Band& b, const std::string& first) {
  const PairedDifference gain = b.gain.value_or(kNoGain);
  const std::string wear_mean = std::string(kReferenceWearKey) + "_mean";
  return Json::object({{"policy", b.policy},
                       {key::kCarrySoc, b.soc == "carried"},
                       {"profit_eur_per_day_per_mwh_mean", Decimals{b.mean, 4}},
                       {"profit_eur_per_day_per_mwh_deviation", Decimals{b.deviation, 4}},
                       {"profit_eur_per_day_per_mwh_min", Decimals{b.low, 4}},
                       {"profit_eur_per_day_per_mwh_max", Decimals{b.high, 4}},
                       {wear_mean.c_str(), Decimals{b.mean_at_reference_wear, 4}},
                       {key::kProfitError, Decimals{b.errors.plain, 4}},
                       {key::kProfitErrorByMonth, Decimals{b.errors.by_month, 4}},
                       {"months", b.errors.months},
                       {key::kGainOver, b.gain ? Json(first) : Json::null()},
                       {key::kGain, Decimals{gain.mean, 4}},
                       {key::kGainError, Decimals{gain.standard_error, 4}},
                       {key::kGainErrorByMonth, Decimals{gain.standard_error_by_month, 4}}});
}

/// Columns of one way of counting; empty without any.
std::string bands_block(const std::vector<Band>& bands, std::string_view soc, std::size_t runs) {
  std::string text = fmt::format(
      "{}, {} runs; EUR per day per MWh of capacity\n{:<18} {:>8} {:>6} {:>8} {:>8} {:>6} {:>8} "
      "{:>8} {:>8} {:>8} {:>11}\n",
      soc == "reset" ? "Each day starts at the same SoC" : "SoC carried over from day to day", runs,
      "policy", "mean", "s.e.", "by month", "gain", "s.e.", "by month", "s.d.", "lowest", "highest",
      wear_column());
  for (const Band& b : bands) {
    if (b.soc != soc || is_under_rules(b.policy)) continue;
    const PairedDifference gain = b.gain.value_or(kNoGain);
    text +=
        fmt::format("{:<18} {:>8} {:>6} {:>8} {:>8} {:>6} {:>8} {:>8} {:>8} {:>8} {:>11}\n",
                    b.policy, number(b.mean), number(b.errors.plain), number(b.errors.by_month),
                    b.gain ? fmt::format("{:+.1f}", gain.mean) : "-", number(gain.standard_error),
                    number(gain.standard_error_by_month), number(b.deviation), number(b.low),
                    number(b.high), number(b.mean_at_reference_wear));
  }
  return text;
}

}  // namespace

std::filesystem::path seed_folder(const std::filesystem::path& folder, std::uint64_t seed) {
  return folder / fmt::format("seed-{}", seed);
}

std::string format_bands(const std::vector<Band>& bands, std::size_t runs) {
  if (bands.empty()) return "";
  return bands_block(bands, "carried", runs) + "\n" + bands_block(bands, "reset", runs) +
         fmt::format(
             "\ns.e.: over days, of the mean over seeds; s.d.: over seeds; gain: day-by-day "
             "difference to {}\nby month: {}\n",
             bands.front().policy, by_month_meaning(bands.front().errors.months));
}

std::string bands_json(const std::vector<Band>& bands, std::size_t runs) {
  Json list = Json::list();
  for (const Band& b : bands) {
    list.add(band_json(b, bands.front().policy));
  }
  Json json = answer("run_bands");
  json.set("runs", runs);
  json.set("bands", std::move(list));
  return json.line();
}

void write_seeds_report(const std::filesystem::path& folder, const std::vector<RunSummary>& runs,
                        const std::vector<UnprovedSeed>& unproved) {
  const std::vector<Band> bands = bands_of(runs);
  write_file(folder / "seeds.csv", bands_csv(bands, runs.size()));
  write_seeds_page(folder, runs, bands, unproved);
}

}  // namespace bess
