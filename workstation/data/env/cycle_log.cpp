#include "workstation/data/env/cycle_log.h"

#include <algorithm>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/price_level.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// Default of the guard: [price] price_age_s_max of the controller.
constexpr int kUsablePriceAgeS = 240;

/// One file; columns are found by name.
class Reader {
 public:
  explicit Reader(const CsvTable& table, const std::string& path) : table_(table), path_(path) {}

  [[nodiscard]] LoggedCycle cycle(std::size_t row) const {
    LoggedCycle c{.utc_s = table_.utc_s(row, utc_),
                  .soc_frac = number(row, soc_) / kSocFullE4,
                  .power_w = number(row, power_),
                  .ordered_w = number(row, ordered_),
                  .reason = text(row, reason_)};
    const std::string& mode = text(row, mode_);
    c.is_cut = c.reason == "power_limit";
    // A cycle whose reading failed has zeros instead.
    c.has_reading = text(row, status_) == "ok" || c.soc_frac != 0;
    c.is_cycle = mode != "stopping";
    c.is_driven = mode == "running";
    c.is_ordered = number(row, written_) != 0 && (c.is_driven || mode == "holding");
    c.has_price = text(row, minute_) != "none";
    if (c.has_price) take_price(row, c);
    if (text(row, student_) != "none") take_decision(row, c);
    return c;
  }

 private:
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const {
    return table_.text(row, column);
  }
  [[nodiscard]] double number(std::size_t row, std::size_t column) const {
    return table_.number(row, column);
  }
  [[nodiscard]] std::int32_t whole(std::size_t row, std::size_t column) const {
    return static_cast<std::int32_t>(number(row, column));
  }

  void take_price(std::size_t row, LoggedCycle& c) const {
    const bool stands_in = number(row, stands_in_) != 0;
    c.price_minute_utc_s = table_.utc_s(row, minute_);
    c.price_eur_per_mwh = number(row, price_) / kCentiPerEur;
    c.decided_eur_per_mwh = stands_in ? number(row, stand_in_) / kCentiPerEur : c.price_eur_per_mwh;
    c.price_age_s = whole(row, age_);
    c.is_price_usable = stands_in || c.utc_s - c.price_minute_utc_s - 60 <= kUsablePriceAgeS;
  }

  void take_decision(std::size_t row, LoggedCycle& c) const {
    for (const Action action : {Action::kDischarge, Action::kIdle, Action::kCharge}) {
      if (text(row, student_) == action_name(action)) c.student = action;
    }
    if (!c.student) {
      fail("{}:{}: student_action \"{}\" is unknown", path_, table_.line(row),
           one_line(text(row, student_), 40));
    }
    c.level_centi =
        PriceLevel{.centi_q16 = static_cast<std::int64_t>(number(row, level_))}.centi_eur_per_mwh();
    if (text(row, outlook_) != "none") c.break_even_centi = whole(row, break_even_);
  }

  const CsvTable& table_;
  const std::string& path_;
  std::size_t utc_ = table_.column("utc"), mode_ = table_.column("mode");
  std::size_t minute_ = table_.column("price_minute_utc");
  std::size_t price_ = table_.column("price_centi_eur_per_mwh");
  std::size_t age_ = table_.column("price_age_s"), soc_ = table_.column("soc_e4");
  std::size_t power_ = table_.column("battery_power_w");
  std::size_t student_ = table_.column("student_action");
  std::size_t ordered_ = table_.column("ordered_power_w"), reason_ = table_.column("reason");
  std::size_t status_ = table_.column("battery_status"), written_ = table_.column("written");
  std::size_t level_ = table_.column("price_level_centi_q16");
  std::size_t outlook_ = table_.column("outlook");
  std::size_t break_even_ = table_.column("break_even_centi");
  std::size_t stands_in_ = table_.column("price_stands_in");
  std::size_t stand_in_ = table_.column("stand_in_centi");
};

void read_into(CycleLog& log, const std::string& path) {
  const std::string contents = read_file(path);
  std::string_view text = contents;
  if (!text.empty() && !text.ends_with('\n')) {
    ++log.torn;
    text = text.substr(0, text.rfind('\n') + 1);
  }
  const CsvTable table(text, path);
  const Reader reader(table, path);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    log.cycles.push_back(reader.cycle(row));
  }
}

}  // namespace

CycleLog read_cycle_log(const std::vector<std::string>& paths) {
  CycleLog log;
  for (const std::string& path : paths) read_into(log, path);
  std::ranges::stable_sort(log.cycles, {}, &LoggedCycle::utc_s);
  const auto doubled = std::ranges::unique(log.cycles, {}, &LoggedCycle::utc_s);
  log.duplicates = static_cast<int>(doubled.size());
  log.cycles.erase(doubled.begin(), doubled.end());
  return log;
}

}  // namespace bess
