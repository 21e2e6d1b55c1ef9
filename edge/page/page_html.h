// The page as HTML that is complete without a script. Every number in it is a <data> element that
// names where in the answers of bess-edge it stands and by what it was divided, so that a test can
// hold each against its source.
#pragma once

#include <string>

#include "edge/page/controller_view.h"

namespace bess {

/// What came of an order; empty = none was given.
struct OrderOutcome {
  std::string text;
  bool is_refused = false;
};

std::string page_html(const ControllerView& view, const PageSettings& settings,
                      const OrderOutcome& outcome = {});

/// A month as a statement to print and to hold beside the bill.
std::string statement_html(const ControllerView& view, const PageSettings& settings);

}  // namespace bess
