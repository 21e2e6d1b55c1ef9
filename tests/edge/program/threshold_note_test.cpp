// The guard's thresholds beside the proved ones: who answers for a price between the two.
#include "edge/program/threshold_note.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

struct ThresholdCase {
  const char* name;
  PriceThresholds guard, proved;
  bool agree;
  const char* text;
};

TEST(ThresholdNote, NamesBothAndWhoAnswersBetweenThem) {
  const ThresholdCase cases[] = {
      {"equal",
       {-120, 640},
       {-120, 640},
       true,
       "charge at or below -120, discharge at or above 640 EUR/MWh, as the student is proved for"},
      {"equal, outside the lattice",
       {-501, 1501},
       {-501, 1501},
       true,
       "charge at or below -501 (the guard's alone), discharge at or above 1501 (the guard's "
       "alone) "
       "EUR/MWh, as the student is proved for"},
      {"guard reaches further, low",
       {-300, 1500},
       {-500, 1500},
       false,
       "[guard] low_price_eur_per_mwh = -300, the student is proved for -500: between them the "
       "guard "
       "alone makes it charge"},
      {"guard reaches further, high",
       {-500, 900},
       {-500, 1500},
       false,
       "[guard] high_price_eur_per_mwh = 900, the student is proved for 1500: between them the "
       "guard "
       "alone makes it discharge"},
      {"guard reaches less far, both",
       {-800, 2000},
       {-500, 1500},
       false,
       "[guard] low_price_eur_per_mwh = -800, the student is proved for -500: between them the "
       "student's proof alone makes it charge; [guard] high_price_eur_per_mwh = 2000, the student "
       "is "
       "proved for 1500: between them the student's proof alone makes it discharge"},
      {"neither answers: the student's lattice ends before both",
       {-800, 2000},
       {-600, 1600},
       false,
       "[guard] low_price_eur_per_mwh = -800, the student is proved for -600: between them nothing "
       "makes it charge; [guard] high_price_eur_per_mwh = 2000, the student is proved for 1600: "
       "between them nothing makes it discharge"},
      {"guard reaches further, proof outside the lattice",
       {-500, 1500},
       {-600, 1500},
       false,
       "[guard] low_price_eur_per_mwh = -500, the student is proved for -600: between them the "
       "guard "
       "alone makes it charge"},
  };
  for (const ThresholdCase& c : cases) {
    SCOPED_TRACE(c.name);
    const ThresholdNote note = compare_thresholds(c.guard, c.proved);
    EXPECT_EQ(note.agree, c.agree);
    EXPECT_EQ(note.text, c.text);
  }
}

}  // namespace
}  // namespace bess
