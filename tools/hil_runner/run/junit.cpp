#include "tools/hil_runner/run/junit.h"

#include <fmt/core.h>

#include <algorithm>
#include <pugixml.hpp>
#include <sstream>

#include "shared/utc_text.h"

namespace bess {

std::string junit_text(const std::vector<Outcome>& outcomes) {
  pugi::xml_document document;
  pugi::xml_node suite = document.append_child("testsuite");
  const auto count = [&](auto&& counts) { return std::ranges::count_if(outcomes, counts); };
  suite.append_attribute("name") = "bess-hil";
  suite.append_attribute("tests") = static_cast<unsigned>(outcomes.size());
  suite.append_attribute("failures") =
      static_cast<unsigned>(count([](const Outcome& o) { return o.error.empty() && o.failed(); }));
  suite.append_attribute("errors") =
      static_cast<unsigned>(count([](const Outcome& o) { return !o.error.empty(); }));
  suite.append_attribute("skipped") =
      static_cast<unsigned>(count([](const Outcome& o) { return !o.skipped.empty(); }));
  for (const Outcome& outcome : outcomes) {
    pugi::xml_node test = suite.append_child("testcase");
    test.append_attribute("classname") = outcome.time();
    test.append_attribute("name") = outcome.scenario.name.c_str();
    test.append_attribute("time") = fmt::format("{:.3f}", outcome.seconds).c_str();
    if (!outcome.skipped.empty()) {
      test.append_child("skipped").append_attribute("message") = outcome.skipped.c_str();
    } else if (!outcome.error.empty()) {
      test.append_child("error").append_attribute("message") = outcome.error.c_str();
    } else if (outcome.failed()) {
      pugi::xml_node failure = test.append_child("failure");
      failure.append_attribute("message") = complaint(outcome).c_str();
      std::string all;
      for (const Finding& f : outcome.findings) {
        all += fmt::format("{}: expected {}, seen {}, at {}\n", f.rule, f.expected, f.seen,
                           utc_text(f.utc_s).view());
      }
      failure.append_child(pugi::node_pcdata).set_value(all.c_str());
    }
  }
  std::ostringstream text;
  document.save(text, "  ");
  return text.str();
}

}  // namespace bess
