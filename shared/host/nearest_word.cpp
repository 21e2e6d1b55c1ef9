#include "shared/host/nearest_word.h"

#include <algorithm>
#include <numeric>

namespace bess {
namespace {

constexpr std::size_t kLettersMax = 40;  // longer words are no slips of the finger

/// Letters to insert, remove, replace or swap with their neighbour (the restricted distance of
/// Damerau).
std::size_t distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), row(b.size() + 1);
  std::iota(last.begin(), last.end(), 0);
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool is_swap = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (is_swap) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
    before_last.swap(last);
    last.swap(row);
  }
  return last[b.size()];
}

}  // namespace

std::string nearest_word(std::string_view given, const std::vector<std::string>& known) {
  if (given.size() < 2 || given.size() > kLettersMax) return {};
  std::string best;
  std::size_t best_distance = given.size() / 3 + 1;
  for (const std::string& word : known) {
    const std::size_t far = word.starts_with(given) ? 0 : distance(given, word);
    if (far >= best_distance) continue;
    best = word;
    best_distance = far;
  }
  return best;
}

std::string did_you_mean(std::string_view given, const std::vector<std::string>& known) {
  const std::string word = nearest_word(given, known);
  return word.empty() ? word : "; did you mean " + word + "?";
}

}  // namespace bess
