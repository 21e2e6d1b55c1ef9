// Texts with a slip of the hand in them, for walks over what reads texts.
#pragma once

#include <string>

#include "tests/edge/walks/walk.h"

namespace bess {

/// `most` characters at most are left out, doubled, replaced or put in; seldom the end is gone.
inline std::string with_slips(Walk& walk, std::string text, int most) {
  static constexpr std::string_view kLetters = "0179-+.,:;\"'{}[]()=# \n\t@/\\aezTZ_%\x01\xff";
  const int slips = walk.number(1, most);
  for (int slip = 0; slip < slips && !text.empty(); ++slip) {
    const auto at = static_cast<std::size_t>(walk.from(0, static_cast<int>(text.size()) - 1));
    const char letter = kLetters[static_cast<std::size_t>(
        walk.from(0, static_cast<std::int64_t>(kLetters.size()) - 1))];
    switch (walk.from(0, 8)) {
      case 0:
      case 1:
        text.erase(at, 1);
        break;
      case 2:
        text.insert(at, 1, text[at]);
        break;
      case 3:
      case 4:
      case 5:
        text[at] = letter;
        break;
      case 6:
      case 7:
        text.insert(at, 1, letter);
        break;
      default:
        if (walk.once_in(4)) text.resize(at);
        break;
    }
  }
  return text;
}

}  // namespace bess
