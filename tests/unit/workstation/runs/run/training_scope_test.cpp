// Training conditions of a model, wherever its file is: evaluate warns of other costs, another
// battery and another price regime.
#include "workstation/runs/run/run_record.h"

#include <gmock/gmock.h>

#include <span>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/training_period.h"
#include "tests/support/output_of_command.h"
#include "tests/support/small_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/policy/rl/teacher.h"
#include "workstation/runs/chain/folder_lock.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

using testing::AllOf;
using testing::Not;

constexpr std::int64_t kDay_s = 86'400;
constexpr std::int64_t kPicasso_s = 1'732'575'600;

/// Standard error of a command.
std::string warnings(const std::string& arguments) { return output_of_command(arguments).errors; }

class LearntFor : public testing::Test {
 protected:
  LearntFor() { write_minute_file(prices_, small_series(), ""); }
  void learn() const {
    warnings("train --prices " + prices_ + " --out " + teacher_ + " --steps 20 --config " + dear_);
  }
  /// A file of days with another start.
  [[nodiscard]] std::string prices_from(std::int64_t start_utc_s, int days = 59) const {
    MinuteSeries series = small_series(days);
    series.start_utc_s = start_utc_s;
    write_minute_file(folder_.file("moved.csv.gz"), series, "");
    return folder_.file("moved.csv.gz");
  }
  [[nodiscard]] std::string evaluated(const std::string& model, const std::string& more = "",
                                      const std::string& prices = "") const {
    return warnings("evaluate --split all --prices " + (prices.empty() ? prices_ : prices) +
                    " --policy " + model + more);
  }

  TemporaryFolder folder_;
  std::string prices_ = folder_.file("prices.csv.gz");
  std::string dear_ = folder_.write("dear.toml", "[costs]\nimport_adder_eur_per_mwh = 42\n");
  std::string teacher_ = folder_.file("teacher.bin");
};

TEST_F(LearntFor, IsInTheTeachersFileAndInThatOfItsStudent) {
  learn();
  const Entries told = load_teacher(teacher_).learnt_for;
  EXPECT_THAT(told,
              testing::Contains(Entries::value_type("[costs] import_adder_eur_per_mwh", "42")));
  EXPECT_EQ(evaluated(teacher_, " --config " + dear_), "");
  const char* const other = "[costs] import_adder_eur_per_mwh 42 0";
  EXPECT_THAT(evaluated(teacher_), Names(other));
  EXPECT_THAT(
      evaluated(teacher_,
                " --delay 3 --config " + folder_.write("small.toml",
                                                       "[battery]\npower_w = 1000000\n"
                                                       "[costs]\nimport_adder_eur_per_mwh = 42\n")),
      AllOf(Names("observation_delay_min 1 3 power_w 4000000 1000000"), Not(Names("[costs]"))));
  const std::string student = folder_.file("student.json");
  StudentFile file = compiled_student();
  file.learnt_for = told;
  save_student(student, file);
  EXPECT_EQ(load_student(student).learnt_for, told);
  EXPECT_THAT(evaluated(student), Names(other));
}

TEST_F(LearntFor, AnotherPriceRegimeIsNamed) {
  learn();
  EXPECT_THAT(evaluated(teacher_, " --config " + dear_), Not(Names("PICASSO")));
  const std::string prices = prices_from(small_series().start_utc_s + 731 * kDay_s);  // of 2025
  EXPECT_THAT(evaluated(teacher_, " --config " + dear_, prices), Names("2024 PICASSO"));
}

/// Two months of which the last six days belong to PICASSO: a fit before them is reported.
TEST_F(LearntFor, AFitBeforeABoundaryIsReportedAfterIt) {
  const std::string prices = prices_from(kPicasso_s - 25 * kDay_s, 30);
  const auto told = Names("2024 PICASSO");
  const std::string test = "evaluate --prices " + prices + " --policy ";
  EXPECT_THAT(warnings(test + "sdp"), AllOf(told, Names("2024-11-01 2024-11-25")));
  EXPECT_EQ(warnings(test + "rbc"), "") << "it has no fit";
  EXPECT_EQ(warnings("evaluate --split val --prices " + prices + " --policy sdp"), "");
  EXPECT_EQ(warnings("evaluate --fit " + prices + " --prices " + prices_ + " --policy rbc"), "");
  EXPECT_THAT(warnings("evaluate --fit " + prices_ + " --prices " + prices + " --policy sdp"),
              told);
  const std::string months = prices_from(kPicasso_s - 61 * kDay_s, 100);
  EXPECT_THAT(warnings("backtest --window-days 30 --policy rbc --prices " + months + " --out " +
                       folder_.file("months")),
              AllOf(Names("2024-11 2024-10-02"), told, Not(testing::HasSubstr("2025-01 "))));
}

/// Only days 26 to 30 of a run are after the boundary.
TEST_F(LearntFor, ARunWithTestDaysAfterABoundaryReportsIt) {
  const std::string prices = prices_from(kPicasso_s - 25 * kDay_s, 30);
  const std::string config = folder_.write("small.toml", "[train]\nmethod = \"sdp\"\n");
  const std::string out = folder_.file("run");
  interruption() = true;  // it ends with its first stage
  EXPECT_THROW(warnings("run --prices " + prices + " --config " + config + " --out " + out),
               Interrupted);
  interruption() = false;
  testing::internal::GetCapturedStdout();
  EXPECT_THAT(testing::internal::GetCapturedStderr(), Names("2024-11-01 2024-11-25 PICASSO"));
}

/// Each month's teacher is trained on the days before it, reports so, and is stored.
TEST_F(LearntFor, ABacktestsTeachersNameTheirPricesAndDays) {
  const std::string out = folder_.file("backtest");
  const std::string command = "backtest --prices " + prices_ +
                              " --window-days 30 --policy sdp teacher --out " + out + " --config " +
                              folder_.write("few.toml", "[train]\nsteps = 20\n");
  warnings(command);
  const std::string model = out + "/2023-02.teacher.bin";
  const Teacher teacher = load_teacher(model);
  EXPECT_THAT(teacher.provenance, Names("prices.csv.gz level 2023-01-02 2023-01-31"));
  EXPECT_THAT(learnt_for_of(model), testing::Contains(testing::Pair(
                                        "prices", Names("crc32 43200 2023-01-01T23:00:00Z"))));
  const std::string kept = read_file(model);
  const std::string answer = read_file(out + "/backtest.json");
  warnings(command);
  EXPECT_EQ(read_file(model), kept);
  EXPECT_EQ(read_file(out + "/backtest.json"), answer);
  const Json json = Json::parse(answer);
  const JsonValue policies = json.value()["policies"];
  const JsonValue of_teacher = *++policies.begin();
  EXPECT_EQ(of_teacher["policy"].text_or(""), std::string("teacher"));
  EXPECT_EQ(of_teacher["days"].number(), 28);
  EXPECT_GT(of_teacher["profit_eur_per_day_per_mwh"].number().value(), 0);
}

TEST(OldPrices, AreReportedByTheClock) {
  const MinuteSeries series = small_series(30);
  const std::int64_t end_utc_s = series.utc_s(series.size());
  EXPECT_EQ(old_prices(series, end_utc_s - 40 * kDay_s), "");
  EXPECT_EQ(old_prices(series, end_utc_s + 179 * kDay_s), "");
  const std::string told = old_prices(series, end_utc_s + 181 * kDay_s);
  const std::string yesterday{local_date_text(end_utc_s + 180 * kDay_s).view()};
  EXPECT_THAT(told, Names("182 prices fetch --from --out --to " + yesterday));
  EXPECT_THAT(old_prices(series, kPicasso_s), Names("PICASSO"));
}

TEST_F(LearntFor, ARunOnOldPricesReportsItUnlessTheyAreSimulated) {
  interruption() = true;  // it ends with its first stage
  for (const bool made_up : {false, true}) {
    write_minute_file(prices_, small_series(30), made_up ? kSimulatedProvenance : "");
    EXPECT_THROW(warnings("run --prices " + prices_ + " --out " + folder_.file("run")),
                 Interrupted);
    testing::internal::GetCapturedStdout();
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(said.find("prices fetch --from") == std::string::npos, made_up) << said;
    std::filesystem::remove_all(folder_.file("run"));
  }
  interruption() = false;
}

TEST(PriceRegimes, BeginAtLocalMidnight) {
  const auto day = [](std::int64_t from_s) { return UtcSpan{from_s, from_s + kDay_s}; };
  const UtcSpan before = day(kPicasso_s - kDay_s);
  for (const PriceRegime& regime : std::span(kPriceRegimes).subspan(1)) {
    EXPECT_EQ(regime.from_utc_s, local_midnight_utc_s(parse_local_date(regime.from_date, "")));
    EXPECT_EQ(regimes_met(day(regime.from_utc_s)), std::vector{&regime});
    EXPECT_EQ(regimes_met(day(regime.from_utc_s - 60)), (std::vector{&regime - 1, &regime}));
  }
  EXPECT_EQ(regimes_not_learnt(before, before), "");
  EXPECT_THAT(regimes_not_learnt(before, day(kPicasso_s)), Names("PICASSO"));
  EXPECT_THAT(regimes_not_learnt(day(kPicasso_s), before), Names("22 2024"));
  EXPECT_EQ(regimes_not_learnt(day(kPicasso_s - 60), before), "") << "trained on a minute of it";
}

}  // namespace
}  // namespace bess
