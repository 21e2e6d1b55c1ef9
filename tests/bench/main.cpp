// Benchmark program bess-bench [NAME...]: runs these benchmarks, or all. --list prints the names.
// "ratio" above 1: ours is better than the peer.
#include <algorithm>
#include <cstdio>
#include <string>

#include "shared/local_time.h"
#include "tests/bench/json_line_reporter.h"
#include "tests/bench/registry.h"

namespace {

constexpr const char* kHelp =
    "bess-bench: ratios to named peers, measured in one run; one JSON object a line\n"
    "Usage: bess-bench [NAME...]     these benchmarks, or all\n"
    "       bess-bench --list        their names\n\n"
    "Examples:\n"
    "  bess-bench c51-step-1t c51-step-2t\n"
    "  bess-bench | tee bench.jsonl\n";

int usage(const char* what, const std::string& name) {
  std::fprintf(stderr, "bess-bench: %s \"%s\" (bess-bench --list prints the names)\n", what,
               name.c_str());
  return 2;
}

}  // namespace

int main(int argc, char** argv) {
  bess::set_market_time_zone();
  bess::register_market_benchmarks();
  bess::register_learning_benchmarks();
  bess::register_student_benchmarks();
  bess::register_correction_benchmarks();
  bess::register_edge_benchmarks();
  const std::vector<std::string>& names = bess::benchmark_names();
  std::string filter;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--help" || word == "-h") {
      std::fputs(kHelp, stdout);
      return 0;
    }
    if (word == "--list") {
      for (const std::string& name : names) std::printf("%s\n", name.c_str());
      return 0;
    }
    if (word.starts_with("-")) return usage("unknown option", word);
    if (std::ranges::find(names, word) == names.end()) return usage("unknown benchmark", word);
    filter += (filter.empty() ? "^(" : "|") + word;
  }
  if (!filter.empty()) filter += ")(@|/|$)";
  bess::JsonLineReporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter, filter.empty() ? "." : filter);
  return 0;
}
