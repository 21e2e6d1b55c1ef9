// What may be ordered by a broker, as the command of bess-edge that does it: the same checks,
// the same refusals, the same line in the journal.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace bess {

using OrderFields = std::map<std::string, std::string, std::less<>>;

struct Order {
  std::vector<std::string>
      words;  ///< of bess-edge, without --config; empty when there is a complaint
  std::string complaint;
};

/// Fields: order = hold (power_w, minutes), release, limit (charge_w, discharge_w, minutes; one of
/// the powers may be empty), unlimit, clear. Whole numbers only.
Order read_order(const OrderFields& fields);

}  // namespace bess
