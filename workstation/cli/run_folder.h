// The run folder: everything that one run of the whole chain leaves behind, and the names it goes by.
#pragma once

#include <filesystem>
#include <string>

#include "workstation/cli/run_config.h"

namespace bess {

struct RunFolder {
  std::filesystem::path path;

  [[nodiscard]] std::filesystem::path config() const { return path / "config.toml"; }
  [[nodiscard]] std::filesystem::path manifest() const { return path / "run.json"; }
  [[nodiscard]] std::filesystem::path simulated_prices() const { return path / "prices.csv.gz"; }
  [[nodiscard]] std::filesystem::path teacher() const { return path / "teacher.bin"; }
  [[nodiscard]] std::filesystem::path training_curve() const { return path / "training_curve.csv"; }
  [[nodiscard]] std::filesystem::path plain_student() const { return path / "student_plain.json"; }
  [[nodiscard]] std::filesystem::path student() const { return path / "student.json"; }
  [[nodiscard]] std::filesystem::path distil_curve() const { return path / "distil_curve.csv"; }
  [[nodiscard]] std::filesystem::path header() const { return path / "student_weights.h"; }
  [[nodiscard]] std::filesystem::path table() const { return path / "evaluation.csv"; }
  [[nodiscard]] std::filesystem::path summary() const { return path / "summary.txt"; }
};

}  // namespace bess
