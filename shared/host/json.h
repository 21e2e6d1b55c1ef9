// JSON reading and writing with cJSON, which only json.cpp includes. Numbers are written in the
// shortest exact form; values that are not finite become null. Use json_reader.h for required
// members and JsonValue for optional ones.
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

struct cJSON;

namespace bess {

/// Number written with `count` decimals.
struct Decimals {
  double value;
  int count;
};

/// View of one value of a Json, which must outlive it. The value may be missing.
class JsonValue {
 public:
  explicit JsonValue(const cJSON* item = nullptr) : item_(item) {}

  [[nodiscard]] bool exists() const { return item_ != nullptr; }
  [[nodiscard]] bool is_null() const;
  [[nodiscard]] bool is_object() const;
  [[nodiscard]] bool is_list() const;
  /// Value if it has that type; text is null-terminated, null if it is not text.
  [[nodiscard]] std::optional<bool> boolean() const;
  [[nodiscard]] std::optional<double> number() const;
  [[nodiscard]] const char* text() const;
  [[nodiscard]] const char* text_or(const char* otherwise) const {
    return text() == nullptr ? otherwise : text();
  }
  /// Key of a member.
  [[nodiscard]] std::string_view key() const;
  /// Member of an object by its key.
  [[nodiscard]] JsonValue operator[](const char* key) const;

  /// for (const JsonValue item : list_or_object); other values are empty.
  class Iterator {
   public:
    explicit Iterator(const cJSON* item) : item_(item) {}
    JsonValue operator*() const { return JsonValue(item_); }
    Iterator& operator++();
    bool operator==(const Iterator&) const = default;

   private:
    const cJSON* item_;
  };
  [[nodiscard]] Iterator begin() const;
  [[nodiscard]] Iterator end() const { return Iterator(nullptr); }
  [[nodiscard]] std::size_t size() const;

 private:
  const cJSON* item_;
};

struct JsonMember;

/// JSON value: parsed, or built from values, lists and members.
class Json {
 public:
  /// Does not exist unless `text` is one JSON value.
  static Json parse(std::string_view text);

  // Implicit conversions: Json::object({{"policy", name}, {"days", 90}, {"profit_eur",
  // Decimals{x, 4}}}).
  Json(std::string_view text);                                      // NOLINT: implicit on purpose
  Json(const std::string& text) : Json(std::string_view(text)) {}   // NOLINT
  Json(const char* text) : Json(std::string_view(text)) {}          // NOLINT
  Json(double number);                                              // NOLINT
  Json(Decimals number);                                            // NOLINT
  Json(std::same_as<bool> auto value) : Json(of_boolean(value)) {}  // NOLINT
  template <std::integral T>
  requires(!std::same_as<T, bool>) Json(T whole)
      : Json(of_whole(std::to_string(whole))) {}  // NOLINT
  template <std::integral T, std::size_t kExtent>
  Json(std::span<T, kExtent> wholes) : Json(list()) {  // NOLINT
    for (const T whole : wholes) add(whole);
  }
  static Json null();
  static Json list();
  template <typename... Values>
  static Json list_of(Values&&... values) {
    Json json = list();
    (json.add(Json(std::forward<Values>(values))), ...);
    return json;
  }
  /// List of `make(item)`; items that are values need no `make`.
  template <typename Items, typename Make = std::identity>
  static Json list_from(const Items& items, Make make = {}) {
    Json json = list();
    for (const auto& item : items) json.add(std::invoke(make, item));
    return json;
  }
  static Json object(std::initializer_list<JsonMember> members = {});

  void set(const char* key, Json value);  ///< appends a member to an object
  void add(Json value);                   ///< appends to a list

  [[nodiscard]] JsonValue value() const { return JsonValue(item_.get()); }
  /// One line, without line end.
  [[nodiscard]] std::string line() const;
  /// For people: one line per member, lists of numbers on one line.
  [[nodiscard]] std::string text() const;

 private:
  struct Delete {
    void operator()(cJSON* item) const;
  };
  explicit Json(cJSON* item) : item_(item) {}
  static Json of_boolean(bool value);
  static Json of_whole(const std::string& digits);

  std::unique_ptr<cJSON, Delete> item_;
};

/// By its first character: object or list, complete or not.
bool looks_like_json(std::string_view text);

struct JsonMember {
  const char* key;
  mutable Json value;  ///< mutable, to move from an initializer list
};

/// `value`, or null if it does not exist.
inline Json value_or_null(bool exists, Json value) {
  return exists ? std::move(value) : Json::null();
}

/// Answer of a server: does not exist unless `text` is one JSON value, where NaN and Infinity, as
/// Python and JavaScript write them, count as null.
Json parse_answer(std::string_view text);

/// Value at "a.b.c" below an object; "": the object itself. Duplicate names are ambiguous and count
/// as absent.
JsonValue value_at(JsonValue object, std::string_view path);

/// UTC seconds: text with an offset (2023-03-26T01:02:00+00:00), or a number of seconds or
/// milliseconds since 1970.
std::optional<std::int64_t> time_in(JsonValue value);

}  // namespace bess
