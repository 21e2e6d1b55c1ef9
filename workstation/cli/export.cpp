// bess-train export: proves a student once more and writes the weight header of the edge.
#include "workstation/student/export.h"

#include <fmt/core.h>

#include <memory>

#include "shared/host/distinct_files.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/chain/common_options.h"
#include "workstation/chain/source_tree.h"
#include "workstation/cli/commands.h"
#include "workstation/student/demand_counts.h"

namespace bess {
namespace {

struct ExportArguments {
  CommonOptions common;
  std::string student;
  std::string out;  ///< empty: the source tree's
};

[[noreturn]] void refuse(const std::string& name, const Certificate& c) {
  fail("{}: refused: {} violations over the lattice ({}); distil it again", name, c.violations(),
       broken_text(demand_counts(c)));
}

void run_export(const ExportArguments& options) {
  const std::string out = options.out.empty() ? header_to_replace().string() : options.out;
  require_distinct({{"--out", out}}, {{"--student", options.student}});
  require_writable(out);
  const Verdict verdict =
      prove(load_student(options.student), options.common.resolve().train.threads);
  const auto* student = std::get_if<ProvedStudent>(&verdict);
  if (student == nullptr) refuse(options.student, student_of(verdict).certificate);
  write_file(out, format_weight_header(*student));
  fmt::print("{}: weights {:08x}, proved, written\n", out, student_weights_hash(student->net()));
}

}  // namespace

void add_export_command(ProgramCommand& app) {
  auto options = std::make_shared<ExportArguments>();
  ProgramCommand command =
      app.subcommand("export", "Prove a student and write it as the edge's weight header");
  command.option("--student", options->student, "Student file").required();
  command.option("--out", options->out,
                 "Header to write; without it edge/generated/student_weights.h of the source tree "
                 "around the current folder, or around this program");
  options->common.add_seed_and_threads(command);
  command.footer(
      "Examples:\n"
      "  bess-train export --student runs/a/student.json\n"
      "  bess-train export --student runs/a/student.json --out build/student/student_weights.h");
  command.runs([options] { run_export(*options); });
}

}  // namespace bess
