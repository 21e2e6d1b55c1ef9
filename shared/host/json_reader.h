// Strict reading of a JSON object: what is missing or of the wrong kind is an error that names file
// and member.
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
  /// `kind` says what the file should be, e.g. "a student file". The object outlives the reader.
  /// Throws UserError when a member stands twice: nobody knows which was meant.
  JsonReader(JsonValue object, std::string file, std::string kind);

  // Each throws UserError when the member is not there, or is something else.
  [[nodiscard]] std::string text(const char* key) const;
  [[nodiscard]] double number(const char* key) const;
  [[nodiscard]] std::int64_t whole(const char* key, std::int64_t min, std::int64_t max) const;
  [[nodiscard]] JsonReader object(const char* key) const;
  /// Exactly as many whole numbers as `out` has room for.
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
        fail("{}: \"{}\" holds something else than integers of {} bits", file_, key, 8 * sizeof(T));
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
