// Strict reading of a JSON object: missing members and wrong types are errors that name file and
// member.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>

#include "shared/host/json.h"
#include "shared/host/user_error.h"

namespace bess {

class JsonReader {
 public:
  /// `kind`: expected kind of file, e.g. "a student file". The object outlives the reader. Throws
  /// UserError for duplicate members.
  JsonReader(JsonValue object, std::string file, std::string kind);

  // All throw UserError if the member is missing or has another type.
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] std::int64_t whole(const char* key, std::int64_t min, std::int64_t max) const;
  [[nodiscard]] JsonReader object(const char* key) const;
  /// Exactly `out.size()` whole numbers.
  template <std::integral T, std::size_t kExtent>
  void wholes(const char* key, std::span<T, kExtent> out) const {
    const JsonValue list = member(key);
    if (!list.is_list() || list.size() != out.size()) {
      fail("{}: \"{}\" is not an array of {} integers", file_, key, out.size());
    }
    auto value = out.begin();
    for (const JsonValue item : list) {
      const double number = item.number().value_or(0.5);
      if (!(number >= std::numeric_limits<T>::min() && number <= std::numeric_limits<T>::max()) ||
          static_cast<double>(static_cast<T>(number)) != number) {
        fail("{}: \"{}\" must contain only integers of {} bits", file_, key, 8 * sizeof(T));
      }
      *value++ = static_cast<T>(number);
    }
  }

 private:
  [[nodiscard]] JsonValue member(const char* key) const;

  JsonValue object_;
  std::string file_, kind_;
};

}  // namespace bess
