// Check that external input is text.
#pragma once

#include <string_view>

#include "shared/host/text.h"

namespace bess {

/// `text` without its byte order mark. Throws UserError for a ZIP archive, UTF-16 or a web page,
/// which are not supported; `name` is used in the message.
std::string_view plain_text(std::string_view text, std::string_view name);

}  // namespace bess
