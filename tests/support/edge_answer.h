// What bess-edge answers to one command line, once it has ended.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "shared/local_text.h"
#include "shared/utc_text.h"
#include "tests/support/programs_under_test.h"
#include "tests/support/simulated_site.h"

namespace bess {

struct Said {
  int exit_code;
  std::string text;
};

/// Waits for its end. `arguments`: without the program.
inline Said edge(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), edge_program());
  ChildProcess child(std::move(arguments));
  std::string text = child.read_all();
  return {child.wait(), std::move(text)};
}

/// A moment as `status` and `why` show it to a person.
inline std::string local_text_of(const std::string& utc) {
  std::int64_t utc_s = 0;
  parse_utc(utc, utc_s);
  set_market_time_zone();
  return local_text(utc_s).c_str();
}

}  // namespace bess
