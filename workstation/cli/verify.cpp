// bess-train verify: proof of an integer student over the whole lattice.
#include <fmt/core.h>

#include <memory>

#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/rules/rule_conflicts.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/correction/student/prove.h"
#include "workstation/runs/chain/common_options.h"
#include "workstation/runs/chain/price_input.h"

namespace bess {
namespace {

struct VerifyArguments {
  CommonOptions common;
  RuleFiles rule_files;
  PriceInput price_input;
  std::string prices;
  std::string student;
  bool exhaustive = false;
  bool json = false;
};

void print_json(const std::string& name, const StudentFile& student, bool exhaustive) {
  const Certificate& c = student.certificate;
  Json json =
      answer("proof", {{"student", name},
                       {"weights_hash", fmt::format("{:08x}", student_weights_hash(student.net))},
                       {"proof_method", exhaustive ? "exhaustive" : "bounds and enumeration"},
                       {"proved", c.covers_lattice_without_violation()}});
  add_certificate(c, json);
  json.set("seconds", Decimals{c.seconds, 3});
  fmt::print("{}\n", json.line());
}

void print_text(const std::string& name, const StudentFile& student) {
  const Certificate& c = student.certificate;
  fmt::print("{} (weights {:08x})\n", name, student_weights_hash(student.net));
  fmt::print("  {} states checked, {} of them evaluated one by one, {:.1f} s\n", c.states_checked,
             c.states_evaluated, c.seconds);
  for (const DemandCount& count : demand_counts(c)) {
    if (count.is_rule) continue;
    fmt::print("  {:<47} {} violations{}\n", fmt::format("{}, {}:", count.name, count.text),
               count.violations, guard_alone_note(count.binds_student));
  }
  fmt::print("{}", rule_count_lines(c));
  fmt::print("{}\n", c.covers_lattice_without_violation() ? "PROVED" : "NOT PROVED");
}

void run_verify(const VerifyArguments& options) {
  const bool compiled = options.student.empty();
  const std::string name = compiled ? "compiled array" : options.student;
  const RunConfig config = options.common.resolve();
  StudentFile claimed = compiled ? compiled_student() : load_student(options.student);
  if (!options.rule_files.paths.empty()) {
    claimed.certificate.rules = options.rule_files.read();
    require_consistent(claimed.certificate.rules, claimed.certificate.thresholds,
                       claimed.net.context.kind);
  }
  MarketSteps market;  // first, because a proof may take minutes
  if (!options.prices.empty()) {
    if (options.json) fail("--prices has no effect with --json; remove one");
    market = market_of(options.price_input.read(options.prices), config.market, options.prices);
  }
  const Verdict verdict = prove(std::move(claimed), config.train.threads, options.exhaustive);
  const StudentFile& student = student_of(verdict);
  if (options.json) {
    print_json(name, student, options.exhaustive);
  } else {
    print_text(name, student);
    fmt::print("{}", broken_rule_lines(student, market, config));
  }
  if (!std::holds_alternative<ProvedStudent>(verdict)) {
    fail("{}: {} violations ({}); repeat bess-train distil before exporting it", name,
         student.certificate.violations(), round_of(student.certificate).text());
  }
}

}  // namespace

void add_verify_command(ProgramCommand& app) {
  auto options = std::make_shared<VerifyArguments>();
  ProgramCommand command =
      app.subcommand("verify", "prove a student over every input (exit code 1 if the proof fails)");
  command.option("--student", options->student,
                 "student file (default: the array compiled into this program)");
  options->rule_files.add(command, "rule files to check instead of the student's own");
  command.option("--prices", options->prices,
                 "minute file: also report how often visited states break a rule");
  options->price_input.add(command);
  command.flag("--exhaustive", options->exhaustive,
               "evaluate every state instead of proving boxes by bounds (takes minutes)");
  command.flag("--json", options->json, "one JSON object");
  options->common.add_config(command);
  options->common.add_threads(command);
  command.footer(
      "Examples:\n"
      "  bess-train verify\n"
      "  bess-train verify --rules my_rules.toml --prices market.csv.gz\n"
      "  bess-train verify --student runs/a/student.json --json");
  command.runs([options] { run_verify(*options); });
}

}  // namespace bess
