// Text of a UserError.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "shared/host/user_error.h"

namespace bess {

/// Of the error that `action` throws; nothing if it throws none.
template <typename Action>
std::string refusal_of(const Action& action) {
  try {
    static_cast<void>(action());
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

/// Fails the test if `action` throws none.
template <typename Action>
std::string user_error_of(const Action& action) {
  const std::string said = refusal_of(action);
  EXPECT_NE(said, "") << "expected a UserError";
  return said;
}

}  // namespace bess
