// Thresholds of the guard against the proved ones: who decides at a price between the two.
#include "edge/app/program/startup.h"

#include <gmock/gmock.h>

#include <set>

#include "tests/support/tokens.h"

namespace bess {
namespace {

struct ThresholdCase {
  PriceThresholds guard, proved;
  const char* codes;  ///< in addition to "[guard]" where they differ
};

/// The text depends on who decides between them: the guard alone, the student alone, or neither.
TEST(ThresholdNote, NamesBothAndWhoDecidesBetweenThem) {
  const ThresholdCase cases[] = {
      {{-120, 640}, {-120, 640}, "-120 640"},
      {{-501, 1501}, {-501, 1501}, "-501 1501"},  // outside the lattice
      {{-300, 1500}, {-500, 1500}, "low_price_eur_per_mwh -300 -500"},
      {{-500, 900}, {-500, 1500}, "high_price_eur_per_mwh 900 1500"},
      {{-800, 2000},
       {-500, 1500},
       "low_price_eur_per_mwh -800 -500 high_price_eur_per_mwh 2000 1500"},
      {{-800, 2000},
       {-600, 1600},
       "low_price_eur_per_mwh -800 -600 high_price_eur_per_mwh 2000 1600"},
      {{-500, 1500}, {-600, 1500}, "low_price_eur_per_mwh -500 -600"},
  };
  std::set<std::string> texts;
  for (const ThresholdCase& c : cases) {
    SCOPED_TRACE(c.codes);
    const SettingsNote note = compare_thresholds(c.guard, c.proved);
    const std::string text(note.text);
    EXPECT_EQ(note.is_warning, c.guard != c.proved);
    EXPECT_THAT(text, Names(c.codes));
    EXPECT_EQ(has_code(text, "[guard]"), note.is_warning);
    std::string words;
    for (const char at : text)
      words += std::string("0123456789").find(at) == std::string::npos ? std::string(1, at) : "";
    texts.insert(words);
  }
  EXPECT_EQ(texts.size(), 6U) << "the low threshold of the third and the last case read alike";
}

}  // namespace
}  // namespace bess
