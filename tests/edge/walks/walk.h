// A long seeded walk over the edges of a part's inputs, and what the part made of it, in one number
// for every so many steps (tests/golden/walks): a change of behaviour that no other test names
// shows here. What is right is said by the tests beside it; a walk says that it is as it was.
// BESS_UPDATE_GOLDEN=1 writes it anew: then say in the commit what has changed, and why.
#pragma once

#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <initializer_list>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "shared/signature.h"
#include "tests/support/golden_file.h"

namespace bess {

class Walk {
 public:
  explicit Walk(std::string name) : name_(std::move(name)), engine_(20'261'124) {}

  /// Between both, ends included; the same on every machine.
  std::int64_t from(std::int64_t least, std::int64_t most) {
    const auto span = static_cast<std::uint64_t>(most - least) + 1;
    return least + static_cast<std::int64_t>(engine_() % span);
  }
  std::int32_t number(std::int64_t least, std::int64_t most) {
    return static_cast<std::int32_t>(from(least, most));
  }
  /// One of them, or a neighbour of it: where a comparison turns.
  std::int32_t edge(std::initializer_list<std::int64_t> edges, std::int64_t apart = 1) {
    return number(-apart, apart) + static_cast<std::int32_t>(one_of(edges));
  }
  std::int64_t one_of(std::initializer_list<std::int64_t> values) {
    return values.begin()[engine_() % values.size()];
  }
  /// In one of `of` cases.
  bool once_in(std::uint64_t of) { return engine_() % of == 0; }

  template <typename... Values>
  void see(Values... values) {
    (signature_.add(static_cast<std::int64_t>(values)), ...);
  }
  void see_text(std::string_view text) {
    for (const char letter : text) signature_.add(letter);
    signature_.add(-1);
  }
  /// A line of the golden file; the next begins anew.
  void end_line(std::string_view about) {
    text_ += fmt::format("{} {:016x}\n", about, signature_.value());
    signature_ = Signature{};
  }
  void end_line(int block) { end_line(fmt::format("{:03}", block)); }
  void hold() const {
    expect_golden(std::string(BESS_SOURCE_DIR) + "/tests/golden/walks/" + name_ + ".txt", text_);
  }

 private:
  std::string name_;
  std::mt19937_64 engine_;
  Signature signature_;
  std::string text_;
};

}  // namespace bess
