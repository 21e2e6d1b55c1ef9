// "Did you mean": of the words that would have been understood, the one that was probably meant.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bess {

/// Empty when none of `known` is near: more than a third of the letters would have to change, or it
/// does not begin with `given`. Of several equally near the first one is taken.
std::string nearest_word(std::string_view given, const std::vector<std::string>& known);

/// "; did you mean WORD?", or nothing.
std::string did_you_mean(std::string_view given, const std::vector<std::string>& known);

}  // namespace bess
