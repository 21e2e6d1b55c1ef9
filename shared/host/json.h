// JSON, read and written through cJSON, which json.cpp alone includes. Numbers are written in the
// shortest form that reads back to them, whole numbers exactly; JSON has no NaN: what is not finite
// becomes null. A text is read with json_reader.h where it must hold something, with JsonValue
// where it may.
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

/// A number that is written with so many decimals.
struct Decimals {
  double value;
  int count;
};

/// A look at one value of a Json, which must outlive it. What is not there may be asked too.
class JsonValue {
 public:
  explicit JsonValue(const cJSON* item = nullptr) : item_(item) {}

  [[nodiscard]] bool exists() const { return item_ != nullptr; }
  [[nodiscard]] bool is_null() const;
  [[nodiscard]] bool is_object() const;
  [[nodiscard]] bool is_list() const;
  /// What is held, when it is of that kind; a text ends in 0, and is null when it is none.
  [[nodiscard]] std::optional<bool> boolean() const;
  [[nodiscard]] std::optional<double> number() const;
  [[nodiscard]] const char* text() const;
  [[nodiscard]] const char* text_or(const char* otherwise) const {
    return text() == nullptr ? otherwise : text();
  }
  /// Of a member: its key.
  [[nodiscard]] std::string_view key() const;
  /// Of an object, by its key.
  [[nodiscard]] JsonValue operator[](const char* key) const;

  /// for (const JsonValue item : list_or_object); anything else holds nothing.
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

/// A JSON value: read from a text, or made of values, lists and members.
class Json {
 public:
  /// Does not exist when `text` is anything else than one JSON value.
  static Json parse(std::string_view text);

  // Whatever can be a value is one: Json::object({{"policy", name}, {"days", 90}, {"profit_eur",
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
  /// What `make` makes of each item; items that are values themselves need none.
  template <typename Items, typename Make = std::identity>
  static Json list_from(const Items& items, Make make = {}) {
    Json json = list();
    for (const auto& item : items) json.add(std::invoke(make, item));
    return json;
  }
  static Json object(std::initializer_list<JsonMember> members = {});

  void set(const char* key, Json value);  ///< of an object; a new member is the last
  void add(Json value);                   ///< to the end of a list

  [[nodiscard]] JsonValue value() const { return JsonValue(item_.get()); }
  /// In one line, without its end.
  [[nodiscard]] std::string line() const;
  /// For people: each member in a line of its own, lists of numbers in one.
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

/// By its first character: an object or a list, whole or not.
bool looks_like_json(std::string_view text);

struct JsonMember {
  const char* key;
  mutable Json value;  ///< is moved from: an initializer list only gives it as const
};

}  // namespace bess
