// What may be ordered by the page, as the command of bess-edge that does it: the same checks, the
// same refusals, the same line in the journal.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace bess {

using FormFields = std::map<std::string, std::string, std::less<>>;

struct PageOrder {
  std::vector<std::string>
      words;  ///< of bess-edge, without --config; empty when there is a complaint
  std::string complaint;
};

/// Fields: order = hold (power_w, minutes), release, limit (charge_w, discharge_w, minutes; one of
/// the powers may be empty), unlimit, clear. Whole numbers only.
PageOrder read_order(const FormFields& fields);

}  // namespace bess
