// Answers of price servers as JSON: what cJSON alone does not say. Names that stand twice in an
// object are ambiguous and count as absent; NaN and Infinity count as null.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "shared/host/json.h"

namespace bess {

/// Does not exist when `text` is anything else than one JSON value. Python and JavaScript write NaN
/// and Infinity, which are no JSON.
Json parse_answer(std::string_view text);

/// The value at "a.b.c" below an object; "" is the object itself.
JsonValue value_at(JsonValue object, std::string_view path);

/// UTC seconds: text with an offset (2023-03-26T01:02:00+00:00), or a number of seconds or
/// milliseconds since 1970.
std::optional<std::int64_t> time_in(JsonValue value);

}  // namespace bess
