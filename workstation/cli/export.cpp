// bess-train export: proves a student once more and writes the weight header of the edge.
#include "workstation/student/export.h"

#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/chain_steps.h"
#include "workstation/cli/commands.h"
#include "workstation/cli/common_options.h"

namespace bess {
namespace {

struct Options {
  CommonOptions common;
  std::string student;
  std::string out = "edge/generated/student_weights.h";
};

void run(const Options& options) {
  const StudentFile student = load_student(options.student);
  export_proved_student(student, options.student, options.out,
                        options.common.resolve().train.threads);
  fmt::print("{}: weights {:08x}, proved, written\n", options.out,
             student_weights_hash(student.net));
}

}  // namespace

void export_proved_student(const StudentFile& student, const std::string& name,
                           const std::string& out, int threads) {
  const Certificate certificate = prove(student, threads);
  if (certificate.violations() != 0) {
    fail("{}: refused: {} violations over the lattice ({} / {} / {}); distil it again", name,
         certificate.violations(), certificate.violations_property_1,
         certificate.violations_property_2, certificate.violations_property_3);
  }
  write_file(out, format_weight_header(student));
}

void add_export_command(ProgramCommand& app) {
  auto options = std::make_shared<Options>();
  ProgramCommand command =
      app.subcommand("export", "Prove a student and write it as the edge's weight header");
  command.option("--student", options->student, "Student file").required();
  command.option("--out", options->out, "Header to write").with_default();
  options->common.add_seed_and_threads(command);
  command.footer(
      "Examples:\n"
      "  bess-train export --student runs/a/student.json\n"
      "  bess-train export --student runs/a/student.json --out build/student/student_weights.h");
  command.runs([options] { run(*options); });
}

}  // namespace bess
