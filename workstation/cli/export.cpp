// bess-train export: weight header of a proved student for the edge, with the signature of its
// build.
#include "workstation/correction/student/export.h"

#include <fmt/core.h>

#include <memory>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/runs/chain/common_options.h"

namespace bess {
namespace {

struct ExportArguments {
  CommonOptions common;
  std::string student;
  std::string out;  ///< empty: the source tree's
};

void print_next(const ExportArguments& options, const std::filesystem::path& folder) {
  if (options.out.empty()) {
    fmt::print("next, here:            cmake --build build --target bess-edge\n");
  } else {
    fmt::print("next, as a package:    tools/package --student {}\n", folder.string());
  }
  fmt::print("or, on a Raspberry Pi: tools/flash update-weights USER@HOST --student {}\n",
             options.student);
}

void run_export(const ExportArguments& options) {
  const std::filesystem::path out =
      options.out.empty() ? header_to_replace() : std::filesystem::path(options.out);
  const auto signature = std::filesystem::path(out).replace_filename(kDecisionSignatureFile);
  require_distinct({{"--out", out.string()}, {kDecisionSignatureFile, signature.string()}},
                   {{"--student", options.student}});
  require_writable(out);
  const bool has_folder = !is_special_file(out);
  if (has_folder) require_writable(signature);
  const Verdict verdict =
      prove(load_student(options.student), options.common.resolve().train.threads);
  const auto* student = std::get_if<ProvedStudent>(&verdict);
  if (student == nullptr) {
    const Certificate& c = student_of(verdict).certificate;
    fail("{}: refused: {} violations over the lattice ({}); repeat bess-train distil",
         options.student, c.violations(), round_of(c).text());
  }
  const std::string decided = decision_signature_line(student->file());
  write_file(out, format_weight_header(*student));
  fmt::print("{}: written{}, weights {:08x}, proved\n", out.string(),
             options.out.empty() ? " into the source tree" : "",
             student_weights_hash(student->file().net));
  if (!has_folder) return;
  write_file(signature, decided + '\n');
  fmt::print("{}: written, {}\n", signature.string(), decided);
  print_next(options, signature.has_parent_path() ? signature.parent_path() : ".");
}

}  // namespace

void add_export_command(ProgramCommand& app) {
  auto options = std::make_shared<ExportArguments>();
  ProgramCommand command =
      app.subcommand("export", "prove a student and export the weight header and its signature");
  command.option("--student", options->student, "student file").required();
  command.option("--out", options->out,
                 "output header (default: edge/generated/student_weights.h of the source tree "
                 "around the current folder or this program)");
  options->common.add_threads(command);
  command.footer(
      "Examples:\n"
      "  bess-train export --student runs/a/student.json\n"
      "  bess-train export --student runs/a/student.json --out build/student/student_weights.h");
  command.runs([options] { run_export(*options); });
}

}  // namespace bess
