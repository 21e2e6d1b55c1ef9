// Colours of every figure. gnuplot draws the light ones; the page replaces each by the CSS variable
// of its name, which changes in dark mode. Blue and orange are distinct in all types of colour
// vision (Okabe and Ito 2008).
#pragma once

#include <array>
#include <string_view>

#include "shared/action.h"  // GCC requires its enumerators, named like colours, first

namespace bess {

struct Colour {
  std::string_view name;   ///< CSS variable without the dashes
  std::string_view light;  ///< #rrggbb, lower case
  std::string_view dark;
};

inline constexpr Colour kInk{"ink", "#1f2933", "#e4e8eb"};
inline constexpr Colour kMuted{"muted", "#66727d", "#9aa6b2"};
inline constexpr Colour kGridLine{"grid", "#dde2e6", "#35404a"};
inline constexpr Colour kIdle{"idle", "#c3cad1", "#56626d"};
inline constexpr Colour kCharge{"charge", "#0072b2", "#4ea8dc"};
inline constexpr Colour kDischarge{"discharge", "#d55e00", "#f08c42"};
inline constexpr Colour kSoft{"soft", "#9fc3da", "#4d7a97"};
inline constexpr Colour kMark{"mark", "#b3007d", "#ff6ad5"};
inline constexpr Colour kPaper{"paper", "#ffffff", "#14191e"};

inline constexpr std::array<Colour, 9> kPalette{kInk,       kMuted, kGridLine, kIdle, kCharge,
                                                kDischarge, kSoft,  kMark,     kPaper};

}  // namespace bess
