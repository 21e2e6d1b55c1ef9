// Text into HTML.
#pragma once

#include <string>
#include <string_view>

namespace bess {

/// & < > " ' become entities.
std::string html_escaped(std::string_view text);

/// A number's hyphen becomes a minus sign: at the start, behind a space or a bracket.
std::string with_true_minus(std::string_view text);

}  // namespace bess
