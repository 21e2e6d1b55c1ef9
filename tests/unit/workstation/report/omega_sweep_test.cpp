#include "tests/support/tokens.h"
#include "workstation/report/figures/walk_forward_figure.h"

#include <gmock/gmock.h>

namespace bess {
namespace {

using testing::HasSubstr;

/// Two days of these profits, 1 MWh.
Evaluation two_days(double first_eur, double second_eur) {
  Evaluation evaluation;
  evaluation.capacity_mwh = 1;
  evaluation.days = {{"2023-01-21", first_eur, 1, 2, 0.5}, {"2023-01-22", second_eur, 1, 2, 0.5}};
  return evaluation;
}

OmegaPoint point(double omega, std::int64_t order_violations, double agreement,
                 const Evaluation& evaluation) {
  OmegaPoint p{omega, {}, 0.25, agreement, evaluation};
  p.certificate.states_checked = 1000;
  p.certificate.set_violations_of(3, order_violations);
  return p;
}

TEST(OmegaSweep, TableAndCsvCountTheSame) {
  const Evaluation teacher = two_days(90, 110);
  const std::vector<OmegaPoint> points{point(1e-6, 0, 0.75, two_days(80, 112)),
                                       point(1, 421, 0.875, two_days(95, 115))};
  EXPECT_EQ(omega_csv(points, teacher),
            "omega,states_checked,violations_property_1,violations_property_2,violations_property_"
            "3,divergence_nats,agreement,profit_eur_per_day_per_mwh,gain_standard_error,"
            "profit_standard_error,gain_eur_per_day_per_mwh,profit_"
            "standard_error_by_month,gain_standard_error_by_month\n"
            "1e-06,1000,0,0,0,0.25,0.750000,96.0000,6.0000,16.0000,-4.0000,,\n"
            "1,1000,0,0,421,0.25,0.875000,105.0000,0.0000,10.0000,5.0000,,\n");
  const std::string table = format_omega_table(points, teacher);
  EXPECT_THAT(table, Names("1000 421"));
  EXPECT_THAT(table, HasSubstr("    -4.0    6.0        -\n"));
  EXPECT_THAT(table, HasSubstr("87.50 %    105.0   10.0        -     +5.0    0.0        -\n"));
}

}  // namespace
}  // namespace bess
