#include "workstation/runs/run/run_backtest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "shared/crc32.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/report/backtest/walk_forward.h"

namespace bess {

namespace {

MarketSteps market_of_days(const MarketSteps& market, const FoldDays& days) {
  auto made = make_fold(market, days.name(), days.first, days.last, {days.window_days});
  if (const auto* skipped = std::get_if<SkippedMonth>(&made)) {
    fail("fold {}: {}; use more prices or another window", skipped->month, skipped->reason);
  }
  return std::move(std::get<Fold>(made).market);
}

namespace fs = std::filesystem;

double number(const JsonValue& value) {
  return value.number().value_or(std::numeric_limits<double>::quiet_NaN());
}

JsonValue chain_of(const JsonValue& backtest) {
  for (const JsonValue policy : backtest["policies"]) {
    if (policy["policy"].text_or("") == std::string_view(kChainName)) return policy;
  }
  return JsonValue{};
}

/// Names the run's folder as kRunPlace, so that the text does not depend on its location.
std::string how_to_make_one(const RunRecord& record) {
  const bool is_own = !fs::path(record.prices).is_absolute();
  return fmt::format(
      "'bess-train backtest --prices {}{}{}{} --config {}{} --seed {} --out {}{}' creates one ({}: "
      "this run's folder)",
      is_own ? kRunPlace : "", record.prices, record.day_ahead.empty() ? "" : " --day-ahead ",
      record.day_ahead, kRunPlace, run_file::kConfig, record.value("seed"), kRunPlace,
      kRunsBacktest, kRunPlace);
}

}  // namespace

std::string FoldDays::name() const {
  return fmt::format("{} to {}, {} days before", format_local_date(first), format_local_date(last),
                     window_days);
}

std::optional<FoldDays> parse_fold_days(const std::string& name) {
  if (name.find(" to ") != 10 || name.find(", ") != 24) return std::nullopt;
  return FoldDays{parse_local_date(name.substr(0, 10), "fold"),
                  parse_local_date(name.substr(14, 10), "fold"),
                  static_cast<int>(std::strtol(name.c_str() + 26, nullptr, 10))};
}

std::vector<std::string> fold_months(const MarketSteps& market) {
  std::vector<std::string> months;
  for (const Fold& fold : make_folds(market, {kFoldWindowDays}).traded)
    months.push_back(fold.month);
  return months;
}

MarketSteps market_of_fold(const MarketSteps& market, const std::string& month) {
  if (const auto days = parse_fold_days(month)) return market_of_days(market, *days);
  Folds folds = make_folds(market, {kFoldWindowDays});
  const auto found = std::ranges::find(folds.traded, month, &Fold::month);
  if (found == folds.traded.end()) {
    fail("fold {}: no such month with half of the {} days before it in these prices", month,
         kFoldWindowDays);
  }
  return std::move(found->market);
}

std::string with_run_folder(std::string text, const fs::path& folder) {
  replace_all(text, kRunPlace, folder.string() + "/");
  return text;
}

std::string learning_identity(const std::string& prices_hash, const RunConfig& config) {
  const std::string keys = format_run_config(config);
  Crc32 crc;
  crc.add_bytes(keys.data(), keys.size());
  return fmt::format("{}, seed {}, configuration crc32 {:08x}", prices_hash, config.train.seed,
                     crc.value());
}

WalkForwardOfRun walk_forward_of(const RunFolder& folder, const RunRecord& record) {
  if (!record.value(kRulesKey).empty()) {
    return {std::nullopt, "this run has rules, and a backtest trains without rules"};
  }
  if (!record.teacher_file.empty()) {
    return {std::nullopt,
            "this run uses the teacher of another run, and a backtest trains its own"};
  }
  const std::string name = fmt::format("{}/{}", kRunsBacktest, kBacktestJson);
  const fs::path path = folder.path / name;
  if (!fs::exists(path)) return {std::nullopt, how_to_make_one(record)};
  const Json json = Json::parse(read_file(path));
  const JsonValue chain = chain_of(json.value());
  const auto profit = chain[key::kProfit].number();
  if (!profit) {
    return {std::nullopt, fmt::format("{} lacks the policy {}", name, kChainName)};
  }
  const std::string identity = learning_identity(record.value("prices"), record.config(folder));
  if (json.value()["learnt_from"].text_or("") != identity) {
    return {std::nullopt, fmt::format("{} has other prices, seed or configuration; "
                                      "remove its folder, then {}",
                                      name, how_to_make_one(record))};
  }
  return {WalkForwardFigure{
              *profit,
              {number(chain[key::kProfitError]), number(chain[key::kProfitErrorByMonth]),
               static_cast<int>(number(chain["months"])), static_cast<int>(number(chain["days"]))},
              fmt::format("{}/{}", kRunsBacktest, kBacktestPage)},
          ""};
}

}  // namespace bess
