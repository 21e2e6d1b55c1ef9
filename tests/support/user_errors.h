// What a call is refused with.
#pragma once

#include <string>

#include "shared/host/user_error.h"

namespace bess {

/// What the UserError says that the call throws; empty where it throws none.
template <typename Call>
std::string refused_with(Call&& call) {
  try {
    call();
  } catch (const UserError& error) {
    return error.what();
  }
  return "";
}

}  // namespace bess
