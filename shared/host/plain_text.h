// Text that comes from outside: refused when it is not text at all, and made fit for a message.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace bess {

/// `text` without its byte order mark. Throws UserError for a ZIP archive, UTF-16 or a web page,
/// which no reader here can use; `name` is used in the message.
std::string_view plain_text(std::string_view text, std::string_view name);

/// At most `size_max` bytes of `text` in one line: control characters, which a terminal would obey,
/// become spaces, and neighbouring spaces one.
std::string one_line(std::string_view text, std::size_t size_max);

/// "1 minute", "2 minutes".
std::string counted(std::size_t count, std::string_view noun);

}  // namespace bess
